#include "server/worker/technique/radiosity/factor_moves.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/worker/technique/radiosity/element_shape.h"

#define ROWS_AT_ONCE 256u // that are taken over together, between two looks at the clock

static bool same_elements(const struct elements *a, const struct elements *b)
{
	const uint32_t faces = a->patches.faces.count;
	return a->patches.count == b->patches.count && faces == b->patches.faces.count &&
	       !memcmp(a->patches.cuts, b->patches.cuts, faces * sizeof *a->patches.cuts) &&
	       !memcmp(a->patches.faces.list, b->patches.faces.list, faces * sizeof *a->patches.faces.list);
}

// The first face with a patch from this one on.
static uint32_t face_from(const struct patches *p, uint32_t patch)
{
	uint32_t low = 0, high = p->faces.count;
	while (low < high) {
		const uint32_t mid = low + (high - low) / 2;
		if (p->cuts[mid].first < patch)
			low = mid + 1;
		else
			high = mid;
	}
	return low;
}

// Patches lie between the corners of their faces.
static void mark_node(struct factor_moves *m, const struct factor_build *b, uint32_t node)
{
	const struct patches *p = &b->elements.patches;
	double(*box)[3] = m->boxes[m->box_count];
	const uint32_t first = b->groups.first[node], end = b->groups.first[node + 1];
	memset(m->moved + first, 1, end - first);
	for (int c = 0; c < 3; c++) {
		box[0][c] = INFINITY;
		box[1][c] = -INFINITY;
	}
	for (uint32_t i = face_from(p, first); i < p->faces.count && p->cuts[i].first < end; i++)
		for (uint32_t k = 0; k < 4 && p->faces.list[i].corner[k] != NONE; k++)
			for (int c = 0; c < 3; c++) {
				const double x = (double)p->vertices[p->faces.list[i].corner[k]].position[c];
				box[0][c] = fmin(box[0][c], x);
				box[1][c] = fmax(box[1][c], x);
			}
	m->box_count += end > first;
}

bool factor_moves_init(struct factor_moves *m, const struct factor_build *from, const struct factor_build *b,
		       const struct resident_scene *scene)
{
	const struct edited *e = &scene->edited;
	*m = (struct factor_moves){.from = from, .window = {.columns_only = true}};
	if (b->options.rows.mirrors || !same_elements(&from->elements, &b->elements))
		return false;
	m->moved = calloc(b->elements.patches.count + 1, sizeof *m->moved);
	m->boxes = calloc(e->move_count + 1, sizeof *m->boxes);
	if (!m->moved || !m->boxes) {
		factor_moves_finish(m);
		return false;
	}
	for (uint32_t i = 0; i < e->move_count; i++)
		mark_node(m, b, e->moves[i].node);
	return true;
}

void factor_moves_finish(struct factor_moves *m)
{
	factors_window_finish(&m->window);
	free(m->moved);
	free(m->boxes);
	*m = (struct factor_moves){0};
}

// Whether all of a box is behind an element's plane. What is within the rounding of floats of it counts as in front.
static bool is_behind(const struct element_shape *shape, const double box[2][3])
{
	double most = 0, size = 0;
	// The box's corner that is farthest in front.
	for (int c = 0; c < 3; c++) {
		most += shape->normal[c] * (box[shape->normal[c] > 0][c] - shape->middle[c]);
		size = fmax(size, fmax(fabs(box[0][c]), fmax(fabs(box[1][c]), fabs(shape->middle[c]))));
	}
	return most < -1e-5 * size;
}

// Whether an element has not moved, and sees nothing that has.
static bool is_apart(const struct factor_moves *m, const struct elements *e, uint32_t element)
{
	struct element_shape shape;
	if (m->moved[element % e->patches.count])
		return false;
	element_shape_get(e, element, &shape);
	bool apart = true;
	for (uint32_t i = 0; apart && i < m->box_count; i++)
		apart = is_behind(&shape, (const double(*)[3])m->boxes[i]);
	return apart;
}

// Whether a row is there and is the same here.
static enum status stays(struct factor_moves *m, const struct factor_build *b, uint32_t element, bool *stay,
			 struct error *err)
{
	struct row_view row;
	*stay = m->from->factors.rows[element].block != NONE && b->factors.rows[element].block == NONE &&
		is_apart(m, &b->elements, element);
	if (!*stay)
		return STATUS_OK;
	const enum status s = factors_window_row(&m->window, &m->from->factors, element, &row, err);
	for (uint32_t i = 0; s == STATUS_OK && *stay && i < row.count; i++)
		*stay = !m->moved[row.columns[i] % b->elements.patches.count];
	return s;
}

// Look at the next rows, and take over those that stay.
static enum status take_some(struct factor_moves *m, struct factor_build *b, struct error *err)
{
	uint32_t elements[ROWS_AT_ONCE], count = 0, next = m->next;
	enum status s = STATUS_OK;
	for (; s == STATUS_OK && next < b->elements.count && next - m->next < ROWS_AT_ONCE; next++) {
		bool stay;
		s = stays(m, b, next, &stay, err);
		if (s == STATUS_OK && stay)
			elements[count++] = next;
	}
	if (s == STATUS_OK && count > 0)
		s = factors_take(&b->factors, &m->from->factors, elements, count, err);
	if (s != STATUS_OK)
		return s;
	b->taken += count;
	m->next = next;
	return STATUS_OK;
}

enum status factor_moves_step(struct factor_moves *m, struct factor_build *b, uint32_t budget_us, bool *done,
			      struct error *err)
{
	const uint64_t start = clock_us();
	enum status s;
	do
		s = take_some(m, b, err);
	while (s == STATUS_OK && m->next < b->elements.count && clock_us() - start < budget_us);
	*done = m->next == b->elements.count;
	return s;
}
