#include "server/loader/obj_polygon.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/limits.h"
#include "server/loader/obj_sweep.h"

#define ROUNDED 2 // distance within which three places were on a line before they were rounded to whole numbers

// A polygon while it is cut.
struct cutting {
	struct obj_polygon *polygon;
	struct obj_sweep_corner *corners; // that are left, in order
	uint32_t count;
	uint32_t made; // triangles
	struct obj_sweep_cut *cuts;
	uint32_t cut_count;
	uint32_t *stack; // corners around what is left
	uint32_t *row; // of a piece, corners that wait
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
	*p = (struct obj_polygon){0};
}

static void add_triangle(struct obj_polygon *p, uint32_t *made, uint32_t a, uint32_t b, uint32_t c)
{
	const uint32_t triangle[3] = {a, b, c};
	memcpy(p->triangles[(*made)++], triangle, sizeof triangle);
}

static void cut_as_fan(struct obj_polygon *p)
{
	uint32_t made = 0;
	for (uint32_t i = 1; i + 1 < p->count; i++)
		add_triangle(p, &made, 0, i, i + 1);
}

// The axis along which the polygon is largest: of its area as a vector (Newell) the largest component. -1 without area.
static int find_axis(const struct obj_polygon *p)
{
	const double *o = p->corners[0];
	double n[3] = {0, 0, 0};
	for (uint32_t i = 1; i + 1 < p->count; i++) {
		double a[3], b[3];
		for (int c = 0; c < 3; c++) {
			a[c] = p->corners[i][c] - o[c];
			b[c] = p->corners[i + 1][c] - o[c];
		}
		for (int c = 0; c < 3; c++)
			n[c] += a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
	}
	int axis = fabs(n[1]) > fabs(n[0]) ? 1 : 0;
	axis = fabs(n[2]) > fabs(n[axis]) ? 2 : axis;
	return fabs(n[axis]) > 0 && isfinite(n[axis]) ? axis : -1;
}

// Lay the polygon along the axis into whole numbers, counterclockwise, its first corner at zero. They are coordinates times
// a power of two: finer ones, doubles hardly have. Returns twice its area.
static obj_area flatten(struct cutting *c, int axis)
{
	const struct obj_polygon *p = c->polygon;
	const int uv[2] = {(axis + 1) % 3, (axis + 2) % 3};
	const double *o = p->corners[0];
	double most = 0;
	int exponent;
	obj_area area = 0;
	for (uint32_t i = 0; i < p->count; i++)
		for (int k = 0; k < 2; k++)
			most = fmax(most, fabs(p->corners[i][uv[k]] - o[uv[k]]));
	frexp(most, &exponent);
	for (uint32_t i = 0; i < p->count; i++) {
		c->corners[i] = (struct obj_sweep_corner){.corner = i};
		for (int k = 0; k < 2; k++)
			c->corners[i].at[k] = (int64_t)ldexp(p->corners[i][uv[k]] - o[uv[k]], OBJ_SWEEP_BITS - exponent);
	}
	c->count = p->count;
	for (uint32_t i = 1; i + 1 < p->count; i++)
		area += obj_sweep_area(c->corners[0].at, c->corners[i].at, c->corners[i + 1].at);
	for (uint32_t i = 0; area < 0 && i < p->count; i++)
		c->corners[i].at[0] = -c->corners[i].at[0];
	return area;
}

// Whether the polygon turns left at every corner, once around.
static bool is_convex(const struct cutting *c)
{
	const struct obj_sweep_corner *last = &c->corners[c->count - 1], *k = c->corners;
	uint32_t lowest = 0;
	for (uint32_t i = 0; i < c->count; last = &k[i++]) {
		const int64_t *next = k[i + 1 < c->count ? i + 1 : 0].at;
		if (obj_sweep_area(last->at, k[i].at, next) <= 0)
			return false;
		lowest += obj_sweep_compare(last->at, k[i].at) > 0 && obj_sweep_compare(k[i].at, next) < 0;
	}
	return lowest == 1;
}

static bool same(const int64_t a[2], const int64_t b[2])
{
	return a[0] == b[0] && a[1] == b[1];
}

// Whether a corner adds nothing: it is where one beside it is, or the side to it turns straight back, as exactly as rounding
// left it.
static bool is_idle(const struct obj_sweep_corner *before, const struct obj_sweep_corner *corner,
		    const struct obj_sweep_corner *after)
{
	const int64_t *a = before->at, *b = corner->at, *c = after->at;
	const int64_t in[2] = {b[0] - a[0], b[1] - a[1]}, out[2] = {c[0] - b[0], c[1] - b[1]};
	const obj_area area = obj_sweep_area(a, b, c), ahead = (obj_area)in[0] * out[0] + (obj_area)in[1] * out[1];
	const obj_area most = (obj_area)ROUNDED * (llabs(in[0]) + llabs(in[1]) + llabs(out[0]) + llabs(out[1]));
	return same(a, b) || same(b, c) || (ahead < 0 && area <= most && area >= -most);
}

// Cut corners off that add nothing, and whatever then adds nothing, until three are left.
static void cut_idle(struct cutting *c)
{
	struct obj_sweep_corner *kept = c->corners;
	uint32_t first = 0, end = 0;
	const uint32_t most = c->polygon->count - 3;
	for (uint32_t i = 0; i < c->count; i++) {
		const struct obj_sweep_corner next = c->corners[i];
		for (; c->made < most && end > 1 && is_idle(&kept[end - 2], &kept[end - 1], &next); end--)
			add_triangle(c->polygon, &c->made, kept[end - 2].corner, kept[end - 1].corner, next.corner);
		kept[end++] = next;
	}
	while (c->made < most) {
		const struct obj_sweep_corner *last = &kept[end - 1], *start = &kept[first];
		if (is_idle(last - 1, last, start)) {
			add_triangle(c->polygon, &c->made, last[-1].corner, last->corner, start->corner);
			end--;
		} else if (is_idle(last, start, start + 1)) {
			add_triangle(c->polygon, &c->made, last->corner, start->corner, start[1].corner);
			first++;
		} else
			break;
	}
	c->corners += first;
	c->count = end - first;
}

// Add a triangle of two corners of one side of a piece, the lower first, and one that lies above.
static void add_across(struct cutting *c, bool is_right, uint32_t low, uint32_t high, uint32_t next)
{
	const struct obj_sweep_corner *k = c->corners;
	add_triangle(c->polygon, &c->made, k[is_right ? low : high].corner, k[is_right ? high : low].corner, k[next].corner);
}

// Whether the next corner on a side sees the last but one, past the last; or the last is at the place of either.
static bool sees(struct cutting *c, bool is_right, uint32_t last_but_one, uint32_t last, uint32_t next)
{
	const int64_t *a = c->corners[last_but_one].at, *b = c->corners[last].at, *n = c->corners[next].at;
	const obj_area area = obj_sweep_area(a, b, n);
	c->polygon->comparisons++;
	return (is_right ? area > 0 : area < 0) || same(a, b) || same(b, n);
}

// Cut a piece that rises on two sides from its lowest corner to its highest. Corners of one side wait in a row that bends
// inwards, behind the last one of the other side, until a corner sees them. Of a piece that does not rise so, which comes of
// a polygon that crosses itself, this makes as many triangles as well.
static void cut_piece(struct cutting *c, const uint32_t *piece, uint32_t count)
{
	const struct obj_sweep_corner *k = c->corners;
	uint32_t *row = c->row, waiting = 1, low = 0, high = 0;
	bool was_right = true;
	for (uint32_t i = 1; i < count; i++) {
		low = k[piece[i]].rank < k[piece[low]].rank ? i : low;
		high = k[piece[i]].rank > k[piece[high]].rank ? i : high;
	}
	uint32_t right = (low + 1) % count, left = (low + count - 1) % count;
	row[0] = piece[low];
	while (right != high || left != high) {
		const bool is_right = k[piece[right]].rank < k[piece[left]].rank;
		const uint32_t next = piece[is_right ? right : left];
		if (is_right != was_right) {
			for (uint32_t i = 1; i < waiting; i++)
				add_across(c, was_right, row[i - 1], row[i], next);
			row[0] = row[waiting - 1];
			waiting = 1;
		}
		for (; waiting > 1 && sees(c, is_right, row[waiting - 2], row[waiting - 1], next); waiting--)
			add_across(c, is_right, row[waiting - 2], row[waiting - 1], next);
		row[waiting++] = next;
		was_right = is_right;
		right = is_right ? (right + 1) % count : right;
		left = is_right ? left : (left + count - 1) % count;
	}
	for (uint32_t i = 1; i < waiting; i++)
		add_across(c, was_right, row[i - 1], row[i], piece[high]);
}

// By the corner where they end, those with the nearest other end first.
static int compare_cuts(const void *pa, const void *pb)
{
	const struct obj_sweep_cut *a = pa, *b = pb;
	return a->to != b->to ? (a->to > b->to) - (a->to < b->to) : (a->from < b->from) - (a->from > b->from);
}

// Go around the polygon, and cut each piece when its last corner is met. A cut that crosses one before it, which comes of a
// polygon that crosses itself, begins at a corner that is gone, and is left out.
static void cut_pieces(struct cutting *c)
{
	struct obj_sweep_corner *k = c->corners;
	uint32_t *stack = c->stack, size = 0, next = 0;
	qsort(c->cuts, c->cut_count, sizeof *c->cuts, compare_cuts);
	for (uint32_t i = 0; i < c->count; i++) {
		stack[size] = i;
		for (; next < c->cut_count && c->cuts[next].to == i; next++) {
			const uint32_t place = k[c->cuts[next].from].place;
			if (place + 1 >= size || stack[place] != c->cuts[next].from)
				continue;
			cut_piece(c, stack + place, size - place + 1);
			size = place + 1;
			stack[size] = i;
		}
		k[i].place = size++;
	}
	if (size > 2)
		cut_piece(c, stack, size);
}

enum status obj_polygon_cut(struct obj_polygon *p, struct error *err)
{
	struct cutting c = {.polygon = p};
	const int axis = p->count > 3 ? find_axis(p) : -1;
	struct obj_sweep_corner *corners = axis < 0 ? NULL : malloc(p->count * sizeof *corners);
	enum status status = STATUS_OK;
	c.corners = corners;
	if (axis >= 0 && !corners)
		return error_set(err, STATUS_MEMORY, "no memory for a face of %u corners", p->count);
	if (axis < 0 || flatten(&c, axis) == 0 || is_convex(&c)) {
		cut_as_fan(p);
		goto done;
	}
	cut_idle(&c);
	if (c.count == 3) {
		add_triangle(p, &c.made, c.corners[0].corner, c.corners[1].corner, c.corners[2].corner);
		goto done;
	}
	c.cuts = malloc(c.count * sizeof *c.cuts);
	c.stack = malloc(c.count * sizeof *c.stack);
	c.row = malloc(c.count * sizeof *c.row);
	if (!c.cuts || !c.stack || !c.row)
		status = error_set(err, STATUS_MEMORY, "no memory for a face of %u corners", p->count);
	else
		status = obj_sweep(c.corners, c.count, c.cuts, &c.cut_count, &p->comparisons, err);
	if (status == STATUS_OK)
		cut_pieces(&c);
done:
	free(c.row);
	free(c.stack);
	free(c.cuts);
	free(corners);
	return status;
}
