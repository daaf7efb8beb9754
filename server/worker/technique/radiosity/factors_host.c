#include "server/worker/technique/radiosity/factors_host.h"

#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"

#define ROWS_AT_ONCE 16u // between two looks at the clock

static bool is_wanted(const struct factors_host *h, uint32_t i)
{
	return h->factors->rows[i].block != NONE && (!h->which || h->which[i]);
}

// Whether the host sees all of the matrix.
static bool is_seen(const struct factors *f)
{
	bool seen = true;
	for (uint32_t i = 0; i < f->block_count; i++)
		seen = seen && f->blocks[i].columns.map && f->blocks[i].values.map;
	return seen;
}

enum status factors_host_init(struct factors_host *h, const struct factors *f, const uint8_t *which, struct error *err)
{
	uint64_t entries = 0;
	*h = (struct factors_host){.factors = f, .which = which};
	if (is_seen(f)) {
		h->next = f->side;
		return STATUS_OK;
	}
	for (uint32_t i = 0; i < f->side; i++)
		entries += is_wanted(h, i) ? f->rows[i].count : 0;
	h->first = calloc((size_t)f->side + 1, sizeof *h->first);
	h->columns = malloc(entries * sizeof *h->columns + 1);
	h->values = malloc(entries * sizeof *h->values + 1);
	if (h->first && h->columns && h->values)
		return STATUS_OK;
	factors_host_finish(h);
	return error_set(err, STATUS_MEMORY, "out of memory");
}

void factors_host_finish(struct factors_host *h)
{
	factors_window_finish(&h->window);
	free(h->first);
	free(h->columns);
	free(h->values);
	*h = (struct factors_host){0};
}

static enum status copy_row(struct factors_host *h, uint32_t i, struct error *err)
{
	struct row_view row = {0};
	const enum status s = is_wanted(h, i) ? factors_window_row(&h->window, h->factors, i, &row, err) : STATUS_OK;
	if (s != STATUS_OK)
		return s;
	h->first[i] = h->count;
	if (row.count > 0) {
		memcpy(h->columns + h->count, row.columns, row.count * sizeof *row.columns);
		memcpy(h->values + h->count, row.values, row.count * sizeof *row.values);
	}
	h->count += row.count;
	return STATUS_OK;
}

enum status factors_host_step(struct factors_host *h, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	while (!factors_host_finished(h)) {
		for (uint32_t i = 0; i < ROWS_AT_ONCE && !factors_host_finished(h); i++) {
			const enum status s = copy_row(h, h->next, err);
			if (s != STATUS_OK)
				return s;
			h->next++;
		}
		if (clock_us() - start >= budget_us)
			break;
	}
	return STATUS_OK;
}

bool factors_host_finished(const struct factors_host *h)
{
	return h->next == h->factors->side;
}

struct row_view factors_host_row(const struct factors_host *h, uint32_t i)
{
	const struct factors_row *r = &h->factors->rows[i];
	if (!is_wanted(h, i))
		return (struct row_view){.count = 0};
	const struct factors_block *b = &h->factors->blocks[r->block];
	return (struct row_view){.columns =
				     h->first ? h->columns + h->first[i] : (const uint32_t *)b->columns.map + r->first,
				 .values = h->first ? h->values + h->first[i] : (const float *)b->values.map + r->first,
				 .count = r->count,
				 .there = true};
}
