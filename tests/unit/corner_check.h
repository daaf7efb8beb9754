// What the tests of values at corners share.
#ifndef CANDIL_TESTS_CORNER_CHECK_H
#define CANDIL_TESTS_CORNER_CHECK_H

#include "tests/unit/patch_mesh.h"

#include <stdlib.h>

#include "server/worker/technique/radiosity/corner_values.h"

// A mesh, its light and what is shown of it. The light is the caller's to fill; it is 0 at first.
struct shown {
	struct elements e;
	struct corners *corners;
	float *light; // 3 floats for each element
	float *values; // 12 floats for each element
	uint32_t budget_us; // of slices
};

static inline void show_by(const struct mesh *m, double edge, uint32_t budget_us, struct shown *s)
{
	struct error err;
	assert_int_equal(elements_init(&s->e, &m->view, &(struct patch_options){.edge = edge}, NULL), STATUS_OK);
	assert_int_equal(corners_create(&s->e, &s->corners, &err), STATUS_OK);
	double last = 0;
	while (!corners_finished(s->corners)) {
		assert_int_equal(corners_step(s->corners, budget_us, &err), STATUS_OK);
		assert_true(corners_progress(s->corners) >= last);
		last = corners_progress(s->corners);
	}
	assert_true(last == 1);
	s->budget_us = budget_us;
	s->light = calloc(s->e.count * 3 + 1, sizeof *s->light);
	s->values = malloc(s->e.count * 12 * sizeof *s->values + 1);
	assert_true(s->light && s->values);
}

static inline void show(const struct mesh *m, double edge, struct shown *s)
{
	show_by(m, edge, UINT32_MAX, s);
}

static inline void evaluate(struct shown *s, const uint8_t *reached)
{
	memset(s->values, 0xFF, s->e.count * 12 * sizeof *s->values); // NaN
	struct corner_values *making;
	struct error err;
	assert_int_equal(corner_values_create(s->corners, s->light, reached, s->values, &making, &err), STATUS_OK);
	while (!corner_values_finished(making))
		corner_values_step(making, s->budget_us);
	corner_values_destroy(making);
}

static inline void unshow(struct shown *s)
{
	corners_destroy(s->corners);
	elements_finish(&s->e);
	free(s->light);
	free(s->values);
}

// Give an element the light of a linear function in its middle.
static inline void light_at_middle(struct shown *s, uint32_t element, const double slope[3])
{
	const struct radiosity_patch *p = &s->e.shapes[element % s->e.patches.count];
	const uint32_t corners = s->e.faces[p->face].v ? 4 : 3;
	double sum = 0;
	for (uint32_t k = 0; k < corners; k++)
		for (uint32_t c = 0; c < 3; c++)
			sum += (double)p->corner[3 * k + c] * slope[c] / corners;
	s->light[3 * element] = (float)sum;
}

// The first channel at a corner of an element, by where that is.
static inline double value_at(const struct shown *s, uint32_t element, const double at[3])
{
	const struct radiosity_patch *p = &s->e.shapes[element % s->e.patches.count];
	for (uint32_t k = 0; k < 4; k++) {
		const double corner[3] = {(double)p->corner[3 * k], (double)p->corner[3 * k + 1],
					  (double)p->corner[3 * k + 2]};
		if (distance(corner, at) < 1e-6)
			return (double)s->values[12 * element + 3 * k];
	}
	fail_msg("element %u has no corner at %g %g %g", element, at[0], at[1], at[2]);
	return 0;
}

// What an element shows of the first channel at a place on one of its sides; false: the place is on none of them.
static inline bool shown_at(const struct shown *s, uint32_t element, const double at[3], double *value)
{
	const struct radiosity_patch *p = &s->e.shapes[element % s->e.patches.count];
	const uint32_t corners = s->e.faces[p->face].v ? 4 : 3;
	for (uint32_t k = 0; k < corners; k++) {
		const uint32_t next = (k + 1) % corners;
		double a[3], b[3];
		for (uint32_t c = 0; c < 3; c++) {
			a[c] = (double)p->corner[3 * k + c];
			b[c] = (double)p->corner[3 * next + c];
		}
		const double length = distance(a, b), t = distance(a, at) / length;
		if (distance(a, at) + distance(at, b) > length * (1 + 1e-6))
			continue;
		*value = (1 - t) * (double)s->values[12 * element + 3 * k] + t * (double)s->values[12 * element + 3 * next];
		return true;
	}
	return false;
}

// At places on the sides of all elements, every other element that is there shows the same, on a floor that is all one
// surface. Returns how many sides have a neighbour that is longer or shorter.
static inline uint32_t check_seams(const struct shown *s, double most)
{
	const uint32_t half = s->e.patches.count;
	uint32_t unequal = 0;
	for (uint32_t i = 0; i < s->e.count; i++) {
		const struct radiosity_patch *p = &s->e.shapes[i % half];
		const uint32_t corners = s->e.faces[p->face].v ? 4 : 3;
		for (uint32_t k = 0; k < corners; k++) {
			uint32_t on[3];
			for (uint32_t n = 0; n < 3; n++) {
				const double t = n == 0 ? 0.08 : n == 1 ? 0.43 : 0.94;
				double at[3], own, other;
				for (uint32_t c = 0; c < 3; c++)
					at[c] = (1 - t) * (double)p->corner[3 * k + c] +
						t * (double)p->corner[3 * ((k + 1) % corners) + c];
				assert_true(shown_at(s, i, at, &own));
				on[n] = i;
				for (uint32_t j = i < half ? 0 : half; j < (i < half ? half : s->e.count); j++) {
					if (j == i || !shown_at(s, j, at, &other))
						continue;
					on[n] = j;
					if (!(fabs(own - other) <= most))
						fail_msg("elements %u and %u show %.9g and %.9g at %g %g %g", i, j, own,
							 other, at[0], at[1], at[2]);
				}
			}
			unequal += i < half && on[0] != on[2];
		}
	}
	return unequal;
}

// Cut a square of `size` at (x, y) into four until chance ends it, and each piece into two triangles or none.
static inline void add_pieces(struct mesh *m, double scale, double x, double y, double size, int depth)
{
	if (depth == 0 || (depth < 4 && noise(&m->seed) < 0.4)) {
		double p[4][3];
		for (int k = 0; k < 4; k++) {
			const double u = x + (k == 1 || k == 2 ? size : 0), v = y + (k > 1 ? size : 0);
			p[k][0] = scale * (0.8 * u - 0.36 * v);
			p[k][1] = scale * (0.6 * u + 0.48 * v);
			p[k][2] = scale * (0.8 * v + 0.1);
		}
		const bool parts = noise(&m->seed) < 0.3;
		const uint32_t material = m->count;
		add(m, p[0], p[1], p[2], material);
		add(m, p[2], p[3], p[0], material + parts);
		return;
	}
	for (int k = 0; k < 4; k++)
		add_pieces(m, scale, x + (k % 2) * size / 2, y + (k / 2) * size / 2, size / 2, depth - 1);
}

// A flat floor in any direction of squares of many sizes, corners of some on the sides of others.
static inline void pieced_floor(struct mesh *m, double scale)
{
	start(m);
	add_pieces(m, scale, 0, 0, 1, 4);
}

// Something with creases beside it.
static inline void cornell_box_beside(struct mesh *m)
{
	for (int i = 0; i < 3; i++)
		add_box(m, (const double[3]){3 + 2 * i, 0, 0.1 * i}, (const double[3]){1, 2, 1}, 0.3 * i, 5000);
}

#endif
