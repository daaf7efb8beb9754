#include "server/worker/technique/radiosity/analytic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/vec3.h"
#include "server/worker/technique/radiosity/element_shape.h"

#define FLOAT_ROUNDING 0x1p-24 // of a coordinate
#define SCAN_MOST 65536u // elements that a batch looks at
#define FIRST_PAIRS 64u // of the first batch, whose time is not known

// A row that is being made: entries in the order of their columns.
struct row {
	uint32_t *columns;
	float *values;
	uint32_t count, room;
	double sum;
};

struct analytic {
	const struct elements *elements;
	struct sight *sight;
	float *share; // of SIGHT_PAIRS_MOST
	uint32_t *other; // of each pair, the element that is not the row's
	struct row row;
	uint32_t element; // whose row is begun; NONE: none is
	uint32_t next; // element that was not looked at yet
	double pair_us; // 0: not known
};

enum status analytic_create(const struct patch_scene *of, uint32_t rays, struct device *device, struct analytic **out,
			    struct error *err)
{
	struct analytic *a = calloc(1, sizeof *a);
	*out = NULL;
	if (!a)
		return error_set(err, STATUS_MEMORY, "out of memory");
	a->elements = of->elements;
	a->element = NONE;
	a->share = malloc(SIGHT_PAIRS_MOST * sizeof *a->share);
	a->other = malloc(SIGHT_PAIRS_MOST * sizeof *a->other);
	enum status s = a->share && a->other ? sight_create(of, rays, device, &a->sight, err)
					     : error_set(err, STATUS_MEMORY, "out of memory");
	if (s != STATUS_OK) {
		analytic_destroy(a);
		return s;
	}
	*out = a;
	return STATUS_OK;
}

void analytic_destroy(struct analytic *a)
{
	if (!a)
		return;
	sight_destroy(a->sight);
	free(a->share);
	free(a->other);
	free(a->row.columns);
	free(a->row.values);
	free(a);
}

bool analytic_compiled(const struct analytic *a)
{
	return sight_compiled(a->sight);
}

enum status analytic_compile(struct analytic *a, struct error *err)
{
	return sight_compile(a->sight, err);
}

uint64_t analytic_bytes(uint32_t faces, uint32_t rays)
{
	return sight_bytes(faces, rays);
}

// ---- whole rows -------------------------------------------------------------------------------------------------------

static enum status row_add(struct row *r, uint32_t column, double value, struct error *err)
{
	if (r->count == r->room) {
		const uint32_t room = r->room ? 2 * r->room : 256;
		uint32_t *columns = realloc(r->columns, room * sizeof *columns);
		r->columns = columns ? columns : r->columns;
		float *values = realloc(r->values, room * sizeof *values);
		r->values = values ? values : r->values;
		if (!columns || !values)
			return error_set(err, STATUS_MEMORY, "out of memory");
		r->room = room;
	}
	r->columns[r->count] = column;
	r->values[r->count++] = (float)value;
	r->sum += value;
	return STATUS_OK;
}

static void row_clear(struct row *r)
{
	r->count = 0;
	r->sum = 0;
}

static double largest(const struct form_polygon *p)
{
	double most = 0;
	for (uint32_t k = 0; k < p->corners; k++)
		for (int c = 0; c < 3; c++)
			most = fmax(most, fabs(p->at[k][c]));
	return most;
}

// Whether no more of a shape is in front of the plane of another than the rounding of their corners to float may have
// brought there: neighbours in a wall, and on a convex body.
static bool barely_faces(const struct element_shape *s, const struct element_shape *plane, double rounding)
{
	for (uint32_t k = 0; k < s->polygon.corners; k++) {
		double r[3];
		for (int c = 0; c < 3; c++)
			r[c] = s->polygon.at[k][c] - plane->middle[c];
		if (vec3_dot(r, plane->normal) > rounding * (1 + sqrt(vec3_dot(r, r)) / plane->radius))
			return false;
	}
	return true;
}

// The unobstructed form factor from one to the other; 0 if it is less than its error. What sees each other only because of
// rounding is not worth the time that its digits take.
static double factor_of(const struct element_shape *from, const struct element_shape *to)
{
	double error;
	const double rounding = FLOAT_ROUNDING * fmax(largest(&from->polygon), largest(&to->polygon));
	const bool doubtful = barely_faces(from, to, rounding) || barely_faces(to, from, rounding);
	const double enough = doubtful ? ANALYTIC_ENOUGH * fmin(from->area, to->area) : 0;
	const double exchange = form_factor_exchange(&from->polygon, &to->polygon, enough, &error);
	return exchange > error ? exchange / from->area : 0;
}

void analytic_begin(struct analytic *a, uint32_t element)
{
	a->element = element;
	a->next = 0;
	row_clear(&a->row);
}

bool analytic_finished(const struct analytic *a)
{
	return a->element == NONE;
}

// Collect the next pairs that may see each other, at most `most`.
static uint32_t collect(struct analytic *a, const struct element_shape *own, uint32_t most)
{
	uint32_t(*pairs)[2] = sight_pairs(a->sight), n = 0;
	const uint32_t left = a->elements->count - a->next, end = a->next + (left < SCAN_MOST ? left : SCAN_MOST);
	for (; a->next < end && n < most; a->next++) {
		struct element_shape other;
		element_shape_get(a->elements, a->next, &other);
		if (!element_shapes_face(own, &other))
			continue;
		pairs[n][0] = a->element;
		pairs[n][1] = a->next;
		a->other[n++] = a->next;
	}
	return n;
}

static enum status batch(struct analytic *a, uint32_t most, struct error *err)
{
	struct element_shape own, other;
	const uint64_t start = clock_us();
	element_shape_get(a->elements, a->element, &own);
	const uint32_t n = collect(a, &own, most);
	enum status s = sight_find(a->sight, n, a->share, err);
	for (uint32_t k = 0; s == STATUS_OK && k < n; k++) {
		if (!(a->share[k] > 0))
			continue;
		element_shape_get(a->elements, a->other[k], &other);
		const double f = factor_of(&own, &other) * (double)a->share[k];
		if ((float)f > 0)
			s = row_add(&a->row, a->other[k], f, err);
	}
	if (n > 0)
		a->pair_us = (double)(clock_us() - start) / n;
	return s;
}

enum status analytic_step(struct analytic *a, uint32_t budget_us, struct factors *factors, struct error *err)
{
	const uint64_t start = clock_us();
	enum status s = STATUS_OK;
	while (s == STATUS_OK && a->element != NONE && a->next < a->elements->count) {
		const uint64_t spent = clock_us() - start;
		if (spent > 0 && spent >= budget_us)
			return STATUS_OK;
		const double fit = a->pair_us > 0 ? (double)(budget_us - spent) / a->pair_us : FIRST_PAIRS;
		s = batch(a,
			  fit < PATCH_GROUP        ? PATCH_GROUP
			  : fit < SIGHT_PAIRS_MOST ? (uint32_t)fit
						   : SIGHT_PAIRS_MOST,
			  err);
	}
	if (s != STATUS_OK || a->element == NONE)
		return s;
	const struct factors_put put = {.element = a->element, .escaped = (float)fmax(0, 1 - a->row.sum)};
	a->element = NONE;
	return factors_put_row(factors, &put, a->row.columns, a->row.values, a->row.count, err);
}
