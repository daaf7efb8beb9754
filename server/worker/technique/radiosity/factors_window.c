#include "server/worker/technique/radiosity/factors_window.h"

#include <stdlib.h>

#define ENTRIES_LEAST 4096u // that are copied at once: fewer take as long

static uint32_t larger(uint32_t a, uint32_t b)
{
	return a > b ? a : b;
}

static bool holds(const struct factors_window *w, const struct factors *f, const struct factors_row *r)
{
	return w->count > 0 && w->changes == f->changes && w->block == r->block && r->first >= w->first &&
	       r->first - w->first + r->count <= w->count;
}

// How many entries to copy from a row on. Where it follows what was copied last, others are likely to follow it.
static uint32_t entries_for(const struct factors_window *w, const struct factors_row *r, uint32_t end)
{
	const bool follows = w->count > 0 && w->block == r->block && r->first >= w->first && r->first - w->first <= w->count;
	const uint32_t more = follows && w->count < FACTORS_WINDOW_ENTRIES / 2 ? 2 * w->count
			      : follows                                        ? FACTORS_WINDOW_ENTRIES
									       : ENTRIES_LEAST;
	const uint32_t wanted = larger(r->count, more), left = end - r->first;
	return wanted < left ? wanted : left;
}

static enum status make_room(struct factors_window *w, uint32_t entries, struct error *err)
{
	if (entries <= w->room)
		return STATUS_OK;
	const bool columns_only = w->columns_only;
	factors_window_finish(w);
	w->columns_only = columns_only;
	w->columns = malloc(entries * sizeof *w->columns);
	w->values = columns_only ? NULL : malloc(entries * sizeof *w->values);
	if (!w->columns || (!columns_only && !w->values))
		return error_set(err, STATUS_MEMORY, "out of memory");
	w->room = entries;
	return STATUS_OK;
}

static enum status copy(struct factors_window *w, const struct factors *f, const struct factors_row *r, struct error *err)
{
	const struct factors_block *b = &f->blocks[r->block];
	const uint32_t entries = entries_for(w, r, b->entries);
	const uint64_t offset = (uint64_t)r->first * sizeof(uint32_t), bytes = (uint64_t)entries * sizeof(uint32_t);
	w->count = 0;
	enum status s = make_room(w, entries, err);
	if (s == STATUS_OK)
		s = buffer_read(&b->columns, f->device, offset, bytes, w->columns, err);
	if (s == STATUS_OK && !w->columns_only)
		s = buffer_read(&b->values, f->device, offset, bytes, w->values, err);
	if (s != STATUS_OK)
		return s;
	w->block = r->block;
	w->first = r->first;
	w->count = entries;
	w->changes = f->changes;
	return STATUS_OK;
}

enum status factors_window_row(struct factors_window *w, const struct factors *f, uint32_t i, struct row_view *row,
			       struct error *err)
{
	const struct factors_row *r = &f->rows[i];
	*row = (struct row_view){.there = r->block != NONE};
	if (!row->there || r->count == 0)
		return STATUS_OK;
	const struct factors_block *b = &f->blocks[r->block];
	if (b->columns.map && b->values.map) {
		row->columns = (const uint32_t *)b->columns.map + r->first;
		row->values = w->columns_only ? NULL : (const float *)b->values.map + r->first;
	} else {
		const enum status s = holds(w, f, r) ? STATUS_OK : copy(w, f, r, err);
		if (s != STATUS_OK)
			return s;
		row->columns = w->columns + (r->first - w->first);
		row->values = w->columns_only ? NULL : w->values + (r->first - w->first);
	}
	row->count = r->count;
	return STATUS_OK;
}

void factors_window_finish(struct factors_window *w)
{
	free(w->columns);
	free(w->values);
	*w = (struct factors_window){0};
}

double row_view_sum(const struct row_view *row)
{
	double sum = 0;
	for (uint32_t k = 0; k < row->count; k++)
		sum += (double)row->values[k];
	return sum;
}
