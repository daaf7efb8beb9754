#include "server/worker/technique/radiosity/factors_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/worker/technique/radiosity/factors_blocks.h"

// ---- the entries in host memory
// -------------------------------------------------------------------------------------------

struct host_block {
	uint32_t *columns;
	float *values;
	bool owned; // else they are the device's memory, which is the host's
};

static void host_free(struct host_block *blocks, uint32_t count)
{
	for (uint32_t i = 0; blocks && i < count; i++)
		if (blocks[i].owned) {
			free(blocks[i].columns);
			free(blocks[i].values);
		}
	free(blocks);
}

static enum status host_read(const struct factors *f, const struct factors_block *b, struct host_block *h, struct error *err)
{
	const uint64_t bytes = (uint64_t)b->entries * sizeof(uint32_t);
	if (b->columns.map && b->values.map) {
		*h = (struct host_block){.columns = b->columns.map, .values = b->values.map};
		return STATUS_OK;
	}
	*h = (struct host_block){.columns = malloc(bytes + 1), .values = malloc(bytes + 1), .owned = true};
	if (!h->columns || !h->values)
		return error_set(err, STATUS_MEMORY, "out of memory");
	enum status s = STATUS_OK;
	if (bytes > 0)
		s = buffer_read(&b->columns, f->device, 0, bytes, h->columns, err);
	if (s == STATUS_OK && bytes > 0)
		s = buffer_read(&b->values, f->device, 0, bytes, h->values, err);
	return s;
}

// All blocks; the caller frees them with host_free.
static enum status host_read_all(const struct factors *f, struct host_block **blocks, struct error *err)
{
	*blocks = calloc(f->block_count ? f->block_count : 1, sizeof **blocks);
	enum status s = *blocks ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; s == STATUS_OK && i < f->block_count; i++)
		s = host_read(f, &f->blocks[i], &(*blocks)[i], err);
	if (s != STATUS_OK) {
		host_free(*blocks, f->block_count);
		*blocks = NULL;
	}
	return s;
}

// A row for reading.
struct row_view {
	const uint32_t *columns;
	float *values;
	uint32_t count;
	bool there;
};

static struct row_view view(const struct factors *f, const struct host_block *blocks, uint32_t i)
{
	const struct factors_row *r = &f->rows[i];
	if (r->block == NONE)
		return (struct row_view){.count = 0};
	return (struct row_view){.columns = blocks[r->block].columns + r->first,
				 .values = blocks[r->block].values + r->first,
				 .count = r->count,
				 .there = true};
}

static double sum_of(const struct row_view *row)
{
	double sum = 0;
	for (uint32_t k = 0; k < row->count; k++)
		sum += (double)row->values[k];
	return sum;
}

// ---- the report
// -----------------------------------------------------------------------------------------------------------

static void check_sums(const struct factors *f, const struct host_block *blocks, struct factors_report *r)
{
	for (uint32_t i = 0; i < f->side; i++) {
		const struct row_view row = view(f, blocks, i);
		if (!row.there)
			continue;
		const double sum = sum_of(&row);
		const double all = sum + (double)f->rows[i].escaped + (double)f->rows[i].cut;
		r->sum_least = r->rows == 0 ? sum : fmin(r->sum_least, sum);
		r->sum_most = fmax(r->sum_most, sum);
		r->sum_mean += sum;
		r->closure_error = fmax(r->closure_error, fabs(all - 1));
		r->rows++;
		r->entries += row.count;
	}
	if (r->rows > 0)
		r->sum_mean /= r->rows;
}

// Rows are gone through in order, so in each of the others what is looked for moves on, and one pass over all suffices:
// `next` is for each row its first entry not before the column that was looked for last.
static void check_reciprocity(const struct factors *f, const struct host_block *blocks, const float *area, uint32_t *next,
			      struct factors_report *r)
{
	double differences = 0, fluxes = 0;
	for (uint32_t i = 0; i < f->side; i++) {
		const struct row_view row = view(f, blocks, i);
		for (uint32_t k = 0; k < row.count; k++) {
			const uint32_t j = row.columns[k];
			const struct row_view other = view(f, blocks, j);
			if (j == i || !other.there)
				continue;
			while (next[j] < other.count && other.columns[next[j]] < i)
				next[j]++;
			const bool seen = next[j] < other.count && other.columns[next[j]] == i;
			// The pair was looked at in row j.
			if (seen && j < i)
				continue;
			const double a = (double)area[i] * (double)row.values[k];
			const double b = seen ? (double)area[j] * (double)other.values[next[j]] : 0;
			const double most = fmax(a, b);
			r->pairs++;
			if (most > 0)
				r->reciprocity_most = fmax(r->reciprocity_most, fabs(a - b) / most);
			differences += fabs(a - b);
			fluxes += most;
		}
	}
	r->reciprocity_mean = fluxes > 0 ? differences / fluxes : 0;
}

enum status factors_check(const struct factors *f, const float *area, struct factors_report *report, struct error *err)
{
	struct host_block *blocks;
	*report = (struct factors_report){0};
	uint32_t *next = calloc(f->side ? f->side : 1, sizeof *next);
	if (!next)
		return error_set(err, STATUS_MEMORY, "out of memory");
	enum status s = host_read_all(f, &blocks, err);
	if (s == STATUS_OK) {
		check_sums(f, blocks, report);
		check_reciprocity(f, blocks, area, next, report);
		host_free(blocks, f->block_count);
	}
	free(next);
	return s;
}

// ---- projections
// ----------------------------------------------------------------------------------------------------------

enum status factors_close(struct factors *f, struct error *err)
{
	struct host_block *blocks;
	enum status s = host_read_all(f, &blocks, err);
	if (s != STATUS_OK)
		return s;
	for (uint32_t i = 0; i < f->side; i++) {
		const struct row_view row = view(f, blocks, i);
		const double sum = sum_of(&row);
		const double all = fmax(1 - (double)f->rows[i].escaped - (double)f->rows[i].cut, 0);
		for (uint32_t k = 0; row.there && sum > 0 && k < row.count; k++)
			row.values[k] = (float)((double)row.values[k] * (all / sum));
	}
	for (uint32_t b = 0; s == STATUS_OK && b < f->block_count; b++)
		if (blocks[b].owned && f->blocks[b].entries > 0)
			s = factors_write(f, &f->blocks[b].values, 0, blocks[b].values, f->blocks[b].entries, err);
	host_free(blocks, f->block_count);
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

static enum status transpose(const struct factors *f, const struct host_block *blocks, struct transposed *t,
			     struct error *err)
{
	t->first = calloc((uint64_t)f->side + 2, sizeof *t->first);
	t->rows = malloc((f->entries + 1) * sizeof *t->rows);
	t->values = malloc((f->entries + 1) * sizeof *t->values);
	if (!t->first || !t->rows || !t->values)
		return error_set(err, STATUS_MEMORY, "out of memory");
	// Counted two places on, so that filling in leaves each column's first one place on, which is where it belongs.
	for (uint32_t i = 0; i < f->side; i++) {
		const struct row_view row = view(f, blocks, i);
		for (uint32_t k = 0; k < row.count; k++)
			t->first[row.columns[k] + 2ull]++;
	}
	for (uint64_t j = 2; j <= f->side; j++)
		t->first[j] += t->first[j - 1];
	for (uint32_t i = 0; i < f->side; i++) {
		const struct row_view row = view(f, blocks, i);
		for (uint32_t k = 0; k < row.count; k++) {
			const uint64_t at = t->first[row.columns[k] + 1ull]++;
			t->rows[at] = i;
			t->values[at] = row.values[k];
		}
	}
	return STATUS_OK;
}

// Merge row i with column i. Returns the number of entries.
static uint32_t merge(const struct factors *f, const struct host_block *blocks, const struct transposed *t,
		      const float *area, uint32_t i, uint32_t *columns, float *values)
{
	const struct row_view row = view(f, blocks, i);
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
	struct host_block *blocks = NULL;
	struct transposed t = {0};
	uint32_t *columns = malloc((f->side ? f->side : 1) * sizeof *columns);
	float *values = malloc((f->side ? f->side : 1) * sizeof *values);
	enum status s = columns && values ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	if (s == STATUS_OK)
		s = host_read_all(f, &blocks, err);
	if (s == STATUS_OK)
		s = transpose(f, blocks, &t, err);
	for (uint32_t i = 0; s == STATUS_OK && i < f->side; i++)
		if (f->rows[i].block != NONE) {
			const struct factors_put put = {.element = i, .escaped = f->rows[i].escaped, .cut = f->rows[i].cut};
			const uint32_t n = merge(f, blocks, &t, area, i, columns, values);
			s = factors_put_row(next, &put, columns, values, n, err);
		}
	host_free(blocks, f->block_count);
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
		*f = next;
		next = old;
	}
	factors_finish(&next);
	return s;
}
