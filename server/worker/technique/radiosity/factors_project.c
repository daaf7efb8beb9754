#include <math.h>
#include <stdlib.h>

#include "server/worker/technique/radiosity/factors_blocks.h"
#include "server/worker/technique/radiosity/factors_check.h"
#include "server/worker/technique/radiosity/factors_host.h"

// Scale the rows of a block, whose values are in host memory.
static void close_rows(const struct factors *f, uint32_t block, float *values)
{
	for (uint32_t i = 0; i < f->side; i++) {
		const struct factors_row *r = &f->rows[i];
		if (r->block != block)
			continue;
		const struct row_view row = {.values = values + r->first, .count = r->count};
		const double sum = row_view_sum(&row), all = fmax(1 - (double)r->escaped - (double)r->cut, 0);
		for (uint32_t k = 0; sum > 0 && k < r->count; k++)
			values[r->first + k] = (float)((double)row.values[k] * (all / sum));
	}
}

enum status factors_close(struct factors *f, struct error *err)
{
	enum status s = STATUS_OK;
	f->changes++;
	for (uint32_t b = 0; s == STATUS_OK && b < f->block_count; b++) {
		const struct buffer *values = &f->blocks[b].values;
		const uint64_t bytes = (uint64_t)f->blocks[b].entries * sizeof(float);
		float *copy = values->map ? NULL : malloc(bytes + 1);
		if (!values->map && !copy)
			return error_set(err, STATUS_MEMORY, "out of memory");
		if (copy && bytes > 0)
			s = buffer_read(values, f->device, 0, bytes, copy, err);
		if (s == STATUS_OK)
			close_rows(f, b, copy ? copy : values->map);
		if (s == STATUS_OK && copy && bytes > 0)
			s = factors_write(f, values, 0, copy, f->blocks[b].entries, err);
		free(copy);
	}
	return s;
}

// The matrix by columns: those of column j are entries first[j] … first[j + 1] - 1, their rows ascending.
struct transposed {
	uint64_t *first;
	uint32_t *rows;
	float *values;
};

static void transposed_free(struct transposed *t)
{
	free(t->first);
	free(t->rows);
	free(t->values);
}

static enum status transpose(const struct factors_host *host, struct transposed *t, struct error *err)
{
	const struct factors *f = host->factors;
	t->first = calloc((uint64_t)f->side + 2, sizeof *t->first);
	t->rows = malloc((f->entries + 1) * sizeof *t->rows);
	t->values = malloc((f->entries + 1) * sizeof *t->values);
	if (!t->first || !t->rows || !t->values)
		return error_set(err, STATUS_MEMORY, "out of memory");
	// Counted two places on, so that filling in leaves each column's first one place on, which is where it belongs.
	for (uint32_t i = 0; i < f->side; i++) {
		const struct row_view row = factors_host_row(host, i);
		for (uint32_t k = 0; k < row.count; k++)
			t->first[row.columns[k] + 2ull]++;
	}
	for (uint64_t j = 2; j <= f->side; j++)
		t->first[j] += t->first[j - 1];
	for (uint32_t i = 0; i < f->side; i++) {
		const struct row_view row = factors_host_row(host, i);
		for (uint32_t k = 0; k < row.count; k++) {
			const uint64_t at = t->first[row.columns[k] + 1ull]++;
			t->rows[at] = i;
			t->values[at] = row.values[k];
		}
	}
	return STATUS_OK;
}

// Merge row i with column i. Returns the number of entries.
static uint32_t merge(const struct factors_host *host, const struct transposed *t, const float *area, uint32_t i,
		      uint32_t *columns, float *values)
{
	const struct factors *f = host->factors;
	const struct row_view row = factors_host_row(host, i);
	uint64_t at = t->first[i];
	const uint64_t end = t->first[i + 1ull];
	uint32_t n = 0;
	for (uint32_t k = 0; k < row.count || at < end;) {
		const uint32_t here = k < row.count ? row.columns[k] : NONE, there = at < end ? t->rows[at] : NONE;
		const uint32_t j = here < there ? here : there;
		const double own = here == j ? (double)row.values[k] : 0, its = there == j ? (double)t->values[at] : 0;
		k += here == j;
		at += there == j;
		// Of a row that was never put nothing is known.
		const bool both = f->rows[j].block != NONE && area[i] > 0;
		columns[n] = j;
		values[n++] = (float)(both ? 0.5 * (own + its * ((double)area[j] / (double)area[i])) : own);
	}
	return n;
}

static enum status average_into(const struct factors *f, const float *area, struct factors *next, struct error *err)
{
	struct factors_host host = {0};
	struct transposed t = {0};
	uint32_t *columns = malloc((f->side ? f->side : 1) * sizeof *columns);
	float *values = malloc((f->side ? f->side : 1) * sizeof *values);
	enum status s = columns && values ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	if (s == STATUS_OK)
		s = factors_host_init(&host, f, NULL, err);
	while (s == STATUS_OK && !factors_host_finished(&host))
		s = factors_host_step(&host, UINT32_MAX, err);
	if (s == STATUS_OK)
		s = transpose(&host, &t, err);
	for (uint32_t i = 0; s == STATUS_OK && i < f->side; i++)
		if (f->rows[i].block != NONE) {
			const struct factors_put put = {.element = i, .escaped = f->rows[i].escaped, .cut = f->rows[i].cut};
			const uint32_t n = merge(&host, &t, area, i, columns, values);
			s = factors_put_row(next, &put, columns, values, n, err);
		}
	factors_host_finish(&host);
	transposed_free(&t);
	free(columns);
	free(values);
	return s;
}

enum status factors_average(struct factors *f, const float *area, struct error *err)
{
	struct factors next;
	enum status s = factors_init(&next, f->device, f->side, err);
	if (s != STATUS_OK)
		return s;
	next.block_entries = f->block_entries;
	next.packs_on_host = f->packs_on_host;
	s = average_into(f, area, &next, err);
	if (s == STATUS_OK) {
		const struct factors old = *f;
		next.changes += old.changes;
		*f = next;
		next = old;
	}
	factors_finish(&next);
	return s;
}
