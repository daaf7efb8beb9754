#include "server/worker/technique/radiosity/factor_moves.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/worker/technique/radiosity/element_shape.h"

#define ROWS_AT_ONCE 64u // between two looks at the clock

static bool same_elements(const struct elements *a, const struct elements *b)
{
	const uint32_t faces = a->patches.faces.count;
	return a->patches.count == b->patches.count && faces == b->patches.faces.count &&
	       !memcmp(a->patches.cuts, b->patches.cuts, faces * sizeof *a->patches.cuts) &&
	       !memcmp(a->patches.faces.list, b->patches.faces.list, faces * sizeof *a->patches.faces.list);
}

static void enlarge(double box[2][3], const struct radiosity_patch *p)
{
	for (int k = 0; k < 4; k++)
		for (int c = 0; c < 3; c++) {
			const double x = (double)p->corner[3 * k + c];
			box[0][c] = fmin(box[0][c], x);
			box[1][c] = fmax(box[1][c], x);
		}
}

static void mark_node(struct factor_moves *m, const struct factor_build *b, uint32_t node)
{
	double(*box)[3] = m->boxes[m->box_count];
	const uint32_t first = b->groups.first[node], end = b->groups.first[node + 1];
	for (int c = 0; c < 3; c++) {
		box[0][c] = INFINITY;
		box[1][c] = -INFINITY;
	}
	for (uint32_t i = first; i < end; i++) {
		m->moved[i] = 1;
		enlarge(box, &b->elements.shapes[i]);
	}
	m->box_count += end > first;
}

bool factor_moves_init(struct factor_moves *m, const struct factor_build *from, const struct factor_build *b,
		       const struct resident_scene *scene)
{
	const struct edited *e = &scene->edited;
	*m = (struct factor_moves){.from = from};
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

static enum status take_row(const struct factor_moves *m, struct factor_build *b, uint32_t element, struct error *err)
{
	const struct factors *from = &m->from->factors;
	const struct factors_row *row = &from->rows[element];
	uint32_t *columns;
	float *values;
	if (row->block == NONE || !is_apart(m, &b->elements, element))
		return STATUS_OK;
	enum status s = factors_read_row(from, element, &columns, &values, err);
	if (s != STATUS_OK)
		return s;
	bool saw = false;
	for (uint32_t i = 0; i < row->count; i++)
		saw = saw || m->moved[columns[i] % b->elements.patches.count];
	if (!saw) {
		const struct factors_put put = {element, row->escaped, row->cut};
		s = factors_put_row(&b->factors, &put, columns, values, row->count, err);
		b->taken += s == STATUS_OK;
	}
	free(columns);
	free(values);
	return s;
}

enum status factor_moves_step(struct factor_moves *m, struct factor_build *b, uint32_t budget_us, bool *done,
			      struct error *err)
{
	const uint64_t start = clock_us();
	enum status s = STATUS_OK;
	do {
		for (uint32_t i = 0; s == STATUS_OK && i < ROWS_AT_ONCE && m->next < b->elements.count; i++) {
			s = take_row(m, b, m->next, err);
			m->next += s == STATUS_OK;
		}
	} while (s == STATUS_OK && m->next < b->elements.count && clock_us() - start < budget_us);
	*done = m->next == b->elements.count;
	return s;
}
