// Rows of form factors: passes over the cells of their elements, and what they have met, sorted, into the matrix.
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/worker/technique/radiosity/hemicube_job.h"
#include "server/worker/technique/radiosity/hemicube_origin.h"

#define DIGIT_BITS 11u

// Sort entries by element, the digits of which go up to those of `side`; `other` is as large. Returns the one that is
// sorted.
static struct hemicube_entry *sort(struct hemicube_entry *entries, struct hemicube_entry *other, uint32_t count,
				   uint32_t side)
{
	for (uint32_t shift = 0; shift < 32 && side >> shift; shift += DIGIT_BITS) {
		uint32_t at[(1u << DIGIT_BITS) + 1] = {0};
		for (uint32_t i = 0; i < count; i++)
			at[(entries[i].element >> shift & ((1u << DIGIT_BITS) - 1)) + 1]++;
		for (uint32_t i = 0; i < 1u << DIGIT_BITS; i++)
			at[i + 1] += at[i];
		for (uint32_t i = 0; i < count; i++)
			other[at[entries[i].element >> shift & ((1u << DIGIT_BITS) - 1)]++] = entries[i];
		struct hemicube_entry *swap = entries;
		entries = other;
		other = swap;
	}
	return entries;
}

static float share_of(const struct hemicube *h, const uint32_t sum[2])
{
	return (float)((sum[1] * 0x1p32 + sum[0]) / ((double)HEMICUBE_UNIT * h->options.origins));
}

// Put one row, whose entries are in host memory; `other` has room for as many.
static enum status put_row(const struct hemicube *h, uint32_t element, const struct hemicube_row *row,
			   struct hemicube_entry *entries, struct hemicube_entry *other, struct factors *factors,
			   struct error *err)
{
	const struct hemicube_entry *sorted = sort(entries, other, row->count, h->elements->count);
	const struct factors_put put = {
	    .element = element, .escaped = share_of(h, row->escaped), .cut = share_of(h, row->cut)};
	uint32_t *columns = malloc((row->count + 1) * (sizeof(uint32_t) + sizeof(float)));
	if (!columns)
		return error_set(err, STATUS_MEMORY, "out of memory");
	float *values = (float *)(columns + row->count);
	for (uint32_t i = 0; i < row->count; i++) {
		columns[i] = sorted[i].element;
		values[i] = share_of(h, sorted[i].weight);
	}
	const enum status s = factors_put_row(factors, &put, columns, values, row->count, err);
	free(columns);
	return s;
}

static enum status put_rows(const struct hemicube *h, const uint32_t *elements, uint32_t count, struct factors *factors,
			    struct error *err)
{
	struct hemicube_row *rows = h->host_rows;
	enum status s = gl_buffer_read(&h->rows, h->device, 0, count * sizeof *rows, rows, err);
	if (s != STATUS_OK)
		return s;
	uint32_t all = 0, most = 0;
	for (uint32_t i = 0; i < count; i++) {
		rows[i].first = all;
		all += rows[i].count;
		most = rows[i].count > most ? rows[i].count : most;
	}
	struct hemicube_entry *entries = malloc(((size_t)all + most + 1) * sizeof *entries);
	if (!entries)
		return error_set(err, STATUS_MEMORY, "out of memory");
	gl_buffer_write(&h->rows, 0, count * sizeof *rows, rows);
	s = hemicube_pack(h, count, err);
	if (s == STATUS_OK && all > 0)
		s = gl_buffer_read(&h->entries, h->device, 0, all * sizeof *entries, entries, err);
	for (uint32_t i = 0; s == STATUS_OK && i < count; i++)
		s = put_row(h, elements[i], &rows[i], entries + rows[i].first, entries + all, factors, err);
	free(entries);
	return s;
}

static enum status sum_rows(struct hemicube *h, const uint32_t *elements, uint32_t count, struct error *err)
{
	const uint32_t origins = h->options.origins;
	const uint64_t cells = (uint64_t)count * origins;
	struct hemicube_level *first = &h->levels[0];
	enum status s = STATUS_OK;
	memset(h->host_rows, 0, count * sizeof *h->host_rows);
	gl_buffer_write(&h->rows, 0, count * sizeof *h->host_rows, h->host_rows);
	for (uint64_t at = 0; s == STATUS_OK && at < cells; at += first->count) {
		first->count = cells - at < h->cells_most ? (uint32_t)(cells - at) : h->cells_most;
		for (uint32_t i = 0; i < first->count; i++) {
			struct hemicube_view *v = &first->views[i];
			*v = (struct hemicube_view){.row = (uint32_t)((at + i) / origins), .faces = HEMICUBE_ALL_FACES};
			hemicube_origin_get(h->elements, elements[v->row], (uint32_t)((at + i) % origins), origins,
					    &v->origin);
		}
		s = hemicube_look(h, err);
	}
	return s;
}

enum status hemicube_compile(struct hemicube *h, struct error *err)
{
	const uint32_t element = 0;
	if (h->compiled)
		return STATUS_OK;
	enum status s = sum_rows(h, &element, 1, err);
	if (s == STATUS_OK && hemicube_has_portals(h))
		s = hemicube_look_anyway(h, err);
	if (s == STATUS_OK)
		s = hemicube_pack(h, 1, err);
	if (s == STATUS_OK)
		s = gl_wait(h->device, "compiling hemicubes", err);
	gl_buffer_clear(&h->dense);
	h->compiled = s == STATUS_OK;
	return s;
}

uint32_t hemicube_batch(const struct hemicube *h, double budget_us)
{
	const double fit = h->row_us > 0 ? budget_us / h->row_us : 1;
	return fit >= h->rows_most ? h->rows_most : fit > 1 ? (uint32_t)fit : 1;
}

enum status hemicube_rows(struct hemicube *h, const uint32_t *elements, uint32_t count, struct factors *factors,
			  struct error *err)
{
	if (count > h->rows_most)
		return error_set(err, STATUS_INTERNAL, "%u rows are more than a batch has", count);
	if (h->options.mirrors != HEMICUBE_MIRRORS_OFF && h->planes.count == 0)
		return error_set(err, STATUS_INTERNAL, "nobody has told what elements reflect");
	if (count == 0)
		return STATUS_OK;
	enum status s = hemicube_compile(h, err);
	const uint64_t start = clock_us();
	if (s == STATUS_OK)
		s = sum_rows(h, elements, count, err);
	if (s == STATUS_OK)
		s = put_rows(h, elements, count, factors, err);
	if (s == STATUS_OK)
		h->row_us = (double)(clock_us() - start) / count;
	else
		gl_buffer_clear(&h->dense);
	return s;
}
