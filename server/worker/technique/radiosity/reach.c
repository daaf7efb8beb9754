#include "server/worker/technique/radiosity/reach.h"

#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"

#define ROWS_AT_ONCE 16u // between two looks at the clock

enum status reach_init(struct reach *r, const struct element_groups *groups, struct error *err)
{
	const size_t count = 2 * (size_t)groups->nodes;
	*r = (struct reach){.groups = groups, .window = {.columns_only = true}};
	r->reached = calloc(count + 1, sizeof *r->reached);
	r->queue = calloc(count + 1, sizeof *r->queue);
	if (r->reached && r->queue)
		return STATUS_OK;
	reach_finish(r);
	return error_set(err, STATUS_MEMORY, "out of memory");
}

void reach_finish(struct reach *r)
{
	factors_window_finish(&r->window);
	free(r->reached);
	free(r->queue);
	*r = (struct reach){0};
}

void reach_add(struct reach *r, uint32_t group)
{
	uint32_t first;
	const uint32_t size = element_groups_elements(r->groups, group, &first);
	if (r->reached[group] || size == 0)
		return;
	r->reached[group] = 1;
	r->queue[r->queued++] = group;
	r->found += size;
}

// ---- along rows ---------------------------------------------------------------------------------------------------------

// The element at a place of the walk; NONE: behind its end.
static uint32_t element_at(const struct reach *r, struct reach_place at)
{
	uint32_t first;
	if (at.group == r->queued)
		return NONE;
	element_groups_elements(r->groups, r->queue[at.group], &first);
	return first + at.row;
}

static struct reach_place after(const struct reach *r, struct reach_place at)
{
	uint32_t first;
	const bool last = at.row + 1 == element_groups_elements(r->groups, r->queue[at.group], &first);
	return last ? (struct reach_place){.group = at.group + 1}
		    : (struct reach_place){.group = at.group, .row = at.row + 1};
}

// Add the groups of a row's columns. They ascend, so a group is looked for once.
static void add_seen(struct reach *r, const struct row_view *row)
{
	uint32_t end = 0;
	for (uint32_t k = 0; k < row->count; k++) {
		if (row->columns[k] < end)
			continue;
		uint32_t first;
		const uint32_t group = element_groups_find(r->groups, row->columns[k]);
		end = element_groups_elements(r->groups, group, &first);
		end += first;
		reach_add(r, group);
	}
}

static bool is_missing(const struct factors *f, uint32_t element)
{
	return f->rows[element].block == NONE;
}

enum status reach_follow(struct reach *r, const struct factors *f, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	do
		for (uint32_t i = 0; i < ROWS_AT_ONCE; i++) {
			const uint32_t element = element_at(r, r->next);
			struct row_view row;
			if (element == NONE || is_missing(f, element))
				return STATUS_OK;
			const enum status s = factors_window_row(&r->window, f, element, &row, err);
			if (s != STATUS_OK)
				return s;
			add_seen(r, &row);
			r->next = after(r, r->next);
			r->followed++;
		}
	while (clock_us() - start < budget_us);
	return STATUS_OK;
}

bool reach_waits(const struct reach *r, const struct factors *f)
{
	const uint32_t element = element_at(r, r->next);
	return element != NONE && is_missing(f, element);
}

uint32_t reach_missing(const struct reach *r, const struct factors *f, uint32_t *elements, uint32_t most)
{
	uint32_t n = 0;
	for (struct reach_place at = r->next; n < most && at.group < r->queued; at = after(r, at)) {
		const uint32_t element = element_at(r, at);
		if (is_missing(f, element))
			elements[n++] = element;
	}
	return n;
}

bool reach_ended(const struct reach *r)
{
	return r->next.group == r->queued;
}

double reach_fraction(const struct reach *r)
{
	return r->found > 0 ? (double)r->followed / (double)r->found : 1;
}

void reach_list(const struct reach *r, uint8_t *elements)
{
	for (uint32_t i = 0; i < 2 * r->groups->nodes; i++) {
		uint32_t first;
		const uint32_t size = element_groups_elements(r->groups, i, &first);
		memset(elements + first, r->reached[i], size);
	}
}
