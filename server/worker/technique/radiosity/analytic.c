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

// ---- near pairs -------------------------------------------------------------------------------------------------------

// By its patch's corners in floats, which is near enough for what is near.
static bool may_be_near(const struct radiosity_patch *p, const struct element_shape *own)
{
	double middle[3] = {0}, radius = 0;
	for (int k = 0; k < 12; k++)
		middle[k % 3] += 0.25 * (double)p->corner[k];
	for (int k = 0; k < 4; k++) {
		const double r[3] = {(double)p->corner[3 * k] - middle[0], (double)p->corner[3 * k + 1] - middle[1],
				     (double)p->corner[3 * k + 2] - middle[2]};
		radius = fmax(radius, vec3_dot(r, r));
	}
	const double d[3] = {middle[0] - own->middle[0], middle[1] - own->middle[1], middle[2] - own->middle[2]};
	const double reach = 1.5 * ANALYTIC_NEAR * (own->radius + sqrt(radius));
	return vec3_dot(d, d) < reach * reach;
}

static bool near(const struct element_shape *a, const struct element_shape *b)
{
	const double d[3] = {a->middle[0] - b->middle[0], a->middle[1] - b->middle[1], a->middle[2] - b->middle[2]};
	const double reach = ANALYTIC_NEAR * (a->radius + b->radius);
	return vec3_dot(d, d) < reach * reach;
}

// Add the row's near pairs, in the order of their elements, behind the n that are there. False: there is no room for all.
static bool collect_near(struct analytic *a, uint32_t element, uint32_t *n)
{
	const struct elements *e = a->elements;
	uint32_t(*pairs)[2] = sight_pairs(a->sight);
	struct element_shape own, other;
	element_shape_get(e, element, &own);
	for (uint32_t side = 0; side < 2; side++)
		for (uint32_t i = 0; i < e->patches.count; i++) {
			if (!may_be_near(&e->shapes[i], &own))
				continue;
			element_shape_get(e, i + side * e->patches.count, &other);
			if (!near(&own, &other) || !element_shapes_face(&own, &other))
				continue;
			if (*n == SIGHT_PAIRS_MOST)
				return false;
			pairs[*n][0] = element;
			pairs[*n][1] = i + side * e->patches.count;
			a->other[(*n)++] = i + side * e->patches.count;
		}
	return true;
}

// A row by rays, and the near pairs of it that see each other wholly.
struct mix {
	uint32_t *columns;
	float *values;
	uint32_t count;
	const uint32_t *near;
	const double *factor;
	uint32_t near_count;
};

// The row with the near entries in place of its own, which is `scale` times what is left of it. Without `out`: the sum of
// the entries that go.
static double merge(const struct mix *m, double scale, struct row *out, enum status *s, struct error *err)
{
	double gone = 0;
	uint32_t k = 0;
	for (uint32_t i = 0; i <= m->count; i++) {
		const uint32_t column = i < m->count ? m->columns[i] : NONE;
		for (; k < m->near_count && m->near[k] < column; k++)
			if (out && *s == STATUS_OK && m->factor[k] > 0)
				*s = row_add(out, m->near[k], m->factor[k], err);
		if (i == m->count)
			break;
		const bool is_near = k < m->near_count && m->near[k] == column;
		const double value = is_near ? m->factor[k] : scale * (double)m->values[i];
		gone += is_near ? (double)m->values[i] : 0;
		if (out && *s == STATUS_OK && value > 0)
			*s = row_add(out, column, value, err);
		k += is_near;
	}
	return gone;
}

static enum status mix_row(struct analytic *a, uint32_t element, struct mix *m, struct factors *factors, struct error *err)
{
	const struct factors_row *row = &factors->rows[element];
	enum status s = factors_read_row(factors, element, &m->columns, &m->values, err);
	if (s != STATUS_OK)
		return s;
	m->count = row->count;
	double whole = (double)row->escaped + (double)row->cut, exact = 0;
	for (uint32_t i = 0; i < m->count; i++)
		whole += (double)m->values[i];
	for (uint32_t k = 0; k < m->near_count; k++)
		exact += m->factor[k];
	const double rest = whole - merge(m, 1, NULL, &s, err);
	// Where no ray went elsewhere there is nothing to scale, and the sum changes by what the rays were off.
	const double scale = rest > 0 ? fmax(0, whole - exact) / rest : 1;
	row_clear(&a->row);
	merge(m, scale, &a->row, &s, err);
	const struct factors_put put = {element, (float)(scale * (double)row->escaped), (float)(scale * (double)row->cut)};
	if (s == STATUS_OK)
		s = factors_put_row(factors, &put, a->row.columns, a->row.values, a->row.count, err);
	free(m->columns);
	free(m->values);
	return s;
}

// Of the pairs first … end - 1, those of one row, keep the ones that see each other wholly, with their factors.
static uint32_t keep_whole(struct analytic *a, uint32_t element, uint32_t first, uint32_t end, double *factor)
{
	struct element_shape own, other;
	uint32_t n = 0;
	element_shape_get(a->elements, element, &own);
	for (uint32_t k = first; k < end; k++) {
		if (a->share[k] < 1)
			continue;
		element_shape_get(a->elements, a->other[k], &other);
		factor[n] = factor_of(&own, &other);
		a->other[first + n++] = a->other[k];
	}
	return n;
}

// So many rows as have room together; *done grows by them.
static enum status near_rows(struct analytic *a, const uint32_t *elements, uint32_t count, uint32_t *done, double *factor,
			     struct factors *factors, struct error *err)
{
	uint32_t ends[ANALYTIC_ROWS_MOST], rows = 0, n = 0;
	for (; *done + rows < count && rows < ANALYTIC_ROWS_MOST; rows++) {
		const uint32_t before = n;
		if (!collect_near(a, elements[*done + rows], &n) && rows > 0) {
			n = before;
			break;
		}
		ends[rows] = n;
	}
	enum status s = sight_find(a->sight, n, a->share, err);
	for (uint32_t i = 0; s == STATUS_OK && i < rows; i++) {
		const uint32_t element = elements[*done + i], first = i ? ends[i - 1] : 0;
		struct mix m = {.near = a->other + first, .factor = factor};
		m.near_count = keep_whole(a, element, first, ends[i], factor);
		s = mix_row(a, element, &m, factors, err);
	}
	*done += rows;
	return s;
}

enum status analytic_near(struct analytic *a, const uint32_t *elements, uint32_t count, struct factors *factors,
			  struct error *err)
{
	double *factor = malloc(SIGHT_PAIRS_MOST * sizeof *factor);
	enum status s = factor ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	a->element = NONE;
	for (uint32_t done = 0; s == STATUS_OK && done < count;)
		s = near_rows(a, elements, count, &done, factor, factors, err);
	free(factor);
	return s;
}
