#include "server/loader/obj_polygon.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/limits.h"

#define MOST_CELLS 1024u // of the grid, along a side

// A corner while its polygon is cut.
struct obj_polygon_work {
	double at[2]; // in a plane, the polygon counterclockwise
	uint32_t before, after; // the corners beside it, of those that are left
	uint32_t queue; // corners to be tried, a ring
	uint32_t in_grid; // corners by cell: those that were not convex at first
	bool is_queued, is_late, is_gone; // is_late: to be tried after all others
	bool blocks; // it is not convex, so an ear must not hold it
};

// The corners that were not convex at first, by place, so that an ear meets only those nearby.
struct grid {
	double min[2], scale[2];
	uint32_t side;
	uint32_t *first; // side · side + 1: where a cell's corners begin in in_grid
};

enum status obj_polygon_reserve(struct obj_polygon *p, size_t count, struct error *err)
{
	if (count > LIMIT_TRIANGLES)
		return error_set(err, STATUS_SCENE_LIMIT, "a face has more than %u corners; split it", LIMIT_TRIANGLES);
	if (count <= p->room)
		return STATUS_OK;
	const size_t room = count + count / 2 + 16;
	void *corners = realloc(p->corners, room * sizeof *p->corners);
	p->corners = corners ? corners : p->corners;
	void *triangles = corners ? realloc(p->triangles, room * sizeof *p->triangles) : NULL;
	p->triangles = triangles ? triangles : p->triangles;
	if (!triangles)
		return error_set(err, STATUS_MEMORY, "no memory for a face of %zu corners", count);
	p->room = room;
	return STATUS_OK;
}

void obj_polygon_finish(struct obj_polygon *p)
{
	free(p->corners);
	free(p->triangles);
	free(p->work);
	*p = (struct obj_polygon){0};
}

static double cross(const double a[2], const double b[2], const double c[2])
{
	return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// Twice the polygon's area as a vector (Newell).
static void find_normal(const struct obj_polygon *p, double n[3])
{
	const double *o = p->corners[0];
	for (uint32_t i = 1; i + 1 < p->count; i++) {
		double a[3], b[3];
		for (int c = 0; c < 3; c++) {
			a[c] = p->corners[i][c] - o[c];
			b[c] = p->corners[i + 1][c] - o[c];
		}
		for (int c = 0; c < 3; c++)
			n[c] += a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
	}
}

// Lay the polygon into the plane of two axes in which it is largest. False if it has no area.
static bool flatten(struct obj_polygon *p)
{
	double n[3] = {0, 0, 0};
	find_normal(p, n);
	int axis = fabs(n[1]) > fabs(n[0]) ? 1 : 0;
	axis = fabs(n[2]) > fabs(n[axis]) ? 2 : axis;
	if (!(fabs(n[axis]) > 0) || !isfinite(n[axis]))
		return false;
	const int u = (axis + (n[axis] > 0 ? 1 : 2)) % 3, v = (axis + (n[axis] > 0 ? 2 : 1)) % 3;
	for (uint32_t i = 0; i < p->count; i++) {
		p->work[i] =
		    (struct obj_polygon_work){.before = i > 0 ? i - 1 : p->count - 1, .after = i + 1 < p->count ? i + 1 : 0};
		p->work[i].at[0] = p->corners[i][u] - p->corners[0][u];
		p->work[i].at[1] = p->corners[i][v] - p->corners[0][v];
	}
	return true;
}

static double turn(const struct obj_polygon_work *w, uint32_t i)
{
	return cross(w[w[i].before].at, w[i].at, w[w[i].after].at);
}

static uint32_t cell_of(const struct grid *g, const double at[2], int axis)
{
	const double cell = (at[axis] - g->min[axis]) * g->scale[axis];
	return cell > 0 ? (uint32_t)fmin(cell, g->side - 1) : 0;
}

// Build the grid of the corners that block: a square of about as many cells.
static bool grid_build(struct grid *g, struct obj_polygon *p, uint32_t blocking)
{
	struct obj_polygon_work *w = p->work;
	double max[2] = {-INFINITY, -INFINITY};
	*g = (struct grid){.min = {INFINITY, INFINITY}};
	g->side = (uint32_t)fmin(ceil(sqrt(blocking)), MOST_CELLS);
	for (uint32_t i = 0; i < p->count; i++)
		for (int c = 0; c < 2 && w[i].blocks; c++) {
			g->min[c] = fmin(g->min[c], w[i].at[c]);
			max[c] = fmax(max[c], w[i].at[c]);
		}
	for (int c = 0; c < 2; c++)
		g->scale[c] = max[c] > g->min[c] ? g->side / (max[c] - g->min[c]) : 0;
	g->first = calloc((size_t)g->side * g->side + 2, sizeof *g->first);
	if (!g->first)
		return false;
	for (uint32_t i = 0; i < p->count; i++)
		if (w[i].blocks)
			g->first[cell_of(g, w[i].at, 1) * g->side + cell_of(g, w[i].at, 0) + 2]++;
	for (uint32_t i = 2; i < g->side * g->side + 2; i++)
		g->first[i] += g->first[i - 1];
	for (uint32_t i = 0; i < p->count; i++)
		if (w[i].blocks)
			w[g->first[cell_of(g, w[i].at, 1) * g->side + cell_of(g, w[i].at, 0) + 1]++].in_grid = i;
	return true;
}

// Whether the way from `from` to `to` enters the angle at `from` that lies left of the side to `right` and right of that to
// `left`.
static bool enters(const double from[2], const double right[2], const double left[2], const double to[2])
{
	return cross(from, right, to) > 0 && cross(from, to, left) > 0;
}

static bool same(const double a[2], const double b[2])
{
	return a[0] == b[0] && a[1] == b[1];
}

// Whether corner q keeps the triangle `t` from being an ear: it lies in it, or it lies on one of its corners and the polygon
// goes from there into the triangle.
static bool is_in_the_way(const struct obj_polygon_work *w, const uint32_t t[3], uint32_t q)
{
	const double *at[3] = {w[t[0]].at, w[t[1]].at, w[t[2]].at};
	for (int k = 0; k < 3; k++) {
		const double *next = at[(k + 1) % 3], *last = at[(k + 2) % 3];
		if (same(w[q].at, at[k]))
			return enters(at[k], next, last, w[w[q].before].at) || enters(at[k], next, last, w[w[q].after].at);
	}
	return cross(at[0], at[1], w[q].at) >= 0 && cross(at[1], at[2], w[q].at) >= 0 && cross(at[2], at[0], w[q].at) >= 0;
}

// Whether the corner adds nothing: it is where one beside it is, or the side to it turns straight back.
static bool is_idle(const struct obj_polygon_work *w, uint32_t i)
{
	const double *a = w[w[i].before].at, *b = w[i].at, *c = w[w[i].after].at;
	const double ahead = (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]);
	return same(a, b) || same(b, c) || (turn(w, i) == 0 && ahead < 0);
}

static bool is_ear(struct obj_polygon *p, const struct grid *g, uint32_t i)
{
	const struct obj_polygon_work *w = p->work;
	const uint32_t t[3] = {w[i].before, i, w[i].after};
	double low[2], high[2];
	uint32_t from[2], to[2];
	if (!(turn(w, i) > 0))
		return is_idle(w, i);
	for (int c = 0; c < 2; c++) {
		const double a = w[t[0]].at[c], b = w[t[1]].at[c], d = w[t[2]].at[c];
		low[c] = fmin(a, fmin(b, d));
		high[c] = fmax(a, fmax(b, d));
	}
	for (int c = 0; c < 2; c++) {
		from[c] = cell_of(g, low, c);
		to[c] = cell_of(g, high, c);
	}
	for (uint32_t y = from[1]; y <= to[1]; y++) {
		const uint32_t last = g->first[y * g->side + to[0] + 1];
		p->steps += to[0] - from[0] + 1;
		for (uint32_t k = g->first[y * g->side + from[0]]; k < last; k++) {
			const uint32_t q = w[k].in_grid;
			p->steps++;
			if (!w[q].blocks || w[q].is_gone || w[q].at[0] < low[0] || w[q].at[0] > high[0] ||
			    w[q].at[1] < low[1] || w[q].at[1] > high[1])
				continue;
			p->steps += 8;
			if (q != t[0] && q != i && q != t[2] && is_in_the_way(w, t, q))
				return false;
		}
	}
	return true;
}

// Cut the corner off, as triangle number `made`.
static void cut_off(struct obj_polygon *p, uint32_t i, uint32_t made)
{
	struct obj_polygon_work *w = p->work;
	const uint32_t before = w[i].before, after = w[i].after;
	const uint32_t triangle[3] = {before, i, after};
	memcpy(p->triangles[made], triangle, sizeof triangle);
	w[i].is_gone = true;
	w[before].after = after;
	w[after].before = before;
	w[before].blocks = w[before].blocks && !(turn(w, before) > 0);
	w[after].blocks = w[after].blocks && !(turn(w, after) > 0);
}

// Corners that wait to be tried.
struct ring {
	uint32_t head, count;
};

static void enqueue(struct obj_polygon *p, struct ring *r, uint32_t i)
{
	if (p->work[i].is_queued)
		return;
	p->work[i].is_queued = true;
	p->work[(uint32_t)(((uint64_t)r->head + r->count++) % p->count)].queue = i;
}

static uint32_t dequeue(struct obj_polygon *p, struct ring *r)
{
	const uint32_t i = p->work[r->head].queue;
	r->head = (r->head + 1) % p->count;
	r->count--;
	p->work[i].is_queued = false;
	return i;
}

// All corners were tried and none is an ear, though others were cut off in between, or the polygon crosses itself. Try all
// that are left again; where that was in vain, `any` becomes the first that is convex, or just one.
static void try_again(struct obj_polygon *p, struct ring *r, uint32_t start, uint32_t left)
{
	for (uint32_t k = 0, i = start; k < left; k++, i = p->work[i].after)
		enqueue(p, r, i);
	p->steps += left;
}

static uint32_t any_corner(struct obj_polygon *p, uint32_t start, uint32_t left)
{
	uint32_t i = start;
	for (uint32_t k = 0; k < left && !(turn(p->work, i) > 0); k++)
		i = p->work[i].after;
	p->steps += left;
	return i;
}

// Cut off what is idle before any ear, because ears are told by the sides at a corner. Returns how many it cut off.
static uint32_t cut_idle(struct obj_polygon *p, uint32_t *start)
{
	uint32_t made = 0, i = 0;
	for (uint32_t seen = 0; seen < p->count && made + 3 < p->count;) {
		const uint32_t before = p->work[i].before;
		const bool idle = is_idle(p->work, i);
		if (idle)
			cut_off(p, i, made++);
		// What lies before it may have become idle.
		seen += idle ? 0 : 1;
		i = idle ? before : p->work[i].after;
	}
	*start = i;
	return made;
}

// Cut off ears until a triangle is left. False if it takes too many steps.
static bool cut_ears(struct obj_polygon *p, const struct grid *g)
{
	struct ring ring = {0};
	uint32_t start, made = cut_idle(p, &start), made_before = UINT32_MAX;
	for (uint32_t k = 0, i = start; k + made < p->count; k++, i = p->work[i].after)
		enqueue(p, &ring, i);
	while (made + 3 < p->count && p->steps <= OBJ_POLYGON_STEPS) {
		uint32_t i = ring.count > 0 ? dequeue(p, &ring) : UINT32_MAX;
		if (i == UINT32_MAX && made != made_before) {
			made_before = made;
			try_again(p, &ring, start, p->count - made);
			continue;
		}
		if (i == UINT32_MAX)
			i = any_corner(p, start, p->count - made);
		else if (p->work[i].is_late && !p->work[i].is_gone) {
			p->work[i].is_late = false;
			enqueue(p, &ring, i);
			continue;
		} else if (p->work[i].is_gone || !is_ear(p, g, i))
			continue;
		cut_off(p, i, made++);
		start = p->work[i].after;
		p->work[start].is_late = p->work[start].is_queued;
		enqueue(p, &ring, p->work[i].before);
		enqueue(p, &ring, start);
	}
	const uint32_t last[3] = {p->work[start].before, start, p->work[start].after};
	memcpy(p->triangles[made], last, sizeof last);
	return p->steps <= OBJ_POLYGON_STEPS;
}

static void cut_as_fan(struct obj_polygon *p)
{
	for (uint32_t i = 0; i + 2 < p->count; i++) {
		const uint32_t triangle[3] = {0, i + 1, i + 2};
		memcpy(p->triangles[i], triangle, sizeof triangle);
	}
}

enum status obj_polygon_cut(struct obj_polygon *p, struct error *err)
{
	if (p->count > p->work_room) {
		void *work = realloc(p->work, p->room * sizeof *p->work);
		if (!work)
			return error_set(err, STATUS_MEMORY, "no memory for a face of %u corners", p->count);
		p->work = work;
		p->work_room = p->room;
	}
	uint32_t blocking = 0;
	const bool flat = p->count > 3 && flatten(p);
	for (uint32_t i = 0; flat && i < p->count; i++) {
		p->work[i].blocks = !(turn(p->work, i) > 0);
		blocking += p->work[i].blocks;
	}
	if (blocking == 0) {
		cut_as_fan(p);
		return STATUS_OK;
	}
	struct grid grid;
	if (!grid_build(&grid, p, blocking))
		return error_set(err, STATUS_MEMORY, "no memory for a face of %u corners", p->count);
	const bool done = cut_ears(p, &grid);
	free(grid.first);
	return done ? STATUS_OK
		    : error_set(err, STATUS_SCENE_LIMIT, "the concave face of %u corners takes too long to cut; split it",
				p->count);
}
