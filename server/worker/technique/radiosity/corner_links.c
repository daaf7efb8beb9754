#include "server/worker/technique/radiosity/corner_links.h"

#include <math.h>
#include <stdlib.h>

#include "server/base/angle.h"
#include "server/base/vec3.h"
#include "server/worker/technique/radiosity/union_find.h"

#define HITS 1024u // corners on one side
#define EXTRA 1u // parts, beside the sides themselves, for each side: more is no mesh, and stays uncut
#define HANGS 2u // for each side: likewise
#define USES 1024u // patches of an edge: likewise
#define SAME_ANGLE 1e-4 // radians: patches that lie on each other
#define AS_LONG 1e-6 // of a length

_Static_assert(8 * (uint64_t)PATCHES_MOST * (1 + EXTRA) < UINT32_MAX, "parts of sides, and corners, are counted in 32 bits");

// A patch that has an edge.
struct corner_use {
	double angle; // around the edge, counter-clockwise about its direction from low to high
	uint32_t side;
	bool along; // its side runs from low to high: its front is seen from where angles are larger
};

// ---- sides ------------------------------------------------------------------------------------------------------------

static uint32_t next_corner(const struct elements *e, uint32_t side)
{
	const uint32_t patch = side / 4, corners = e->faces[e->shapes[patch].face].v ? 4 : 3;
	return 4 * patch + (side % 4 + 1) % corners;
}

static int by_ends(const void *a, const void *b)
{
	const struct corner_edge *p = a, *q = b;
	if (p->low != q->low)
		return p->low < q->low ? -1 : 1;
	if (p->high != q->high)
		return p->high < q->high ? -1 : 1;
	return p->side < q->side ? -1 : p->side > q->side;
}

static struct corner_edge edge_between(uint32_t a, uint32_t b, uint32_t side)
{
	return (struct corner_edge){a < b ? a : b, a < b ? b : a, side};
}

// From one place to another.
static void way(const struct corner_places *p, uint32_t from, uint32_t to, double out[3])
{
	for (int c = 0; c < 3; c++)
		out[c] = (double)p->at[to][c] - (double)p->at[from][c];
}

// After the edge at `from`, the first whose ends are others.
static uint32_t span_end(const struct corner_edge *edges, uint32_t count, uint32_t from)
{
	uint32_t end = from + 1;
	while (end < count && edges[end].low == edges[from].low && edges[end].high == edges[from].high)
		end++;
	return end;
}

uint64_t corner_links_bytes(uint32_t patches)
{
	const uint64_t sides = 4 * (uint64_t)patches, edges = sides * (1 + EXTRA), hangs = sides * HANGS;
	return 2 * edges * sizeof(struct corner_edge) + USES * sizeof(struct corner_use) + 2 * sides * sizeof(uint32_t) +
	       (hangs + hangs / 2) * sizeof(struct corner_hang) + 4096;
}

enum status corner_links_init(struct corner_links *l, const struct corner_places *places, struct error *err)
{
	const struct elements *e = places->elements;
	const uint32_t sides = 4 * e->patches.count;
	*l = (struct corner_links){.places = places, .edge_most = sides * (1 + EXTRA)};
	l->sides = malloc(sides * sizeof *l->sides + 1);
	l->edges = malloc(l->edge_most * sizeof *l->edges + 1);
	l->same = malloc(2 * (uint64_t)sides * sizeof *l->same + 1);
	l->uses = malloc(USES * sizeof *l->uses);
	struct corner_edge *spare = malloc(sides * sizeof *spare + 1);
	if (!l->sides || !l->edges || !l->same || !l->uses || !spare) {
		free(spare);
		corner_links_finish(l);
		return error_set(err, STATUS_MEMORY, "out of memory");
	}
	for (uint32_t i = 0; i < 2 * sides; i++)
		l->same[i] = i;
	for (uint32_t i = 0; i < sides; i++) {
		const uint32_t from = places->of[i], to = from == NONE ? NONE : places->of[next_corner(e, i)];
		if (from != to)
			l->sides[l->side_count++] = edge_between(from, to, i);
	}
	sliced_sort_begin(&l->sort, l->sides, spare, l->side_count, sizeof *spare, by_ends);
	l->sides = NULL; // the sort's
	return STATUS_OK;
}

void corner_links_finish(struct corner_links *l)
{
	free(l->sort.items);
	free(l->sort.spare);
	free(l->uses);
	free(l->hangs);
	free(l->same);
	free(l->edges);
	free(l->sides);
	*l = (struct corner_links){0};
}

// ---- cutting ----------------------------------------------------------------------------------------------------------

static int by_t(const void *a, const void *b)
{
	const struct corner_hit *p = a, *q = b;
	if (p->t != q->t)
		return p->t < q->t ? -1 : 1;
	return p->point < q->point ? -1 : p->point > q->point;
}

// The places on a side, its ends left out, in order. Returns their number.
static uint32_t find_on(const struct corner_places *p, const struct corner_edge *side, struct corner_hit *hits,
			uint64_t *left)
{
	// What stands for a place may be as far from it again.
	struct corner_segment segment = {.reach = 2 * corner_places_reach(p, side->side / 4)};
	uint32_t n = 0;
	way(p, side->low, side->high, segment.along);
	for (int c = 0; c < 3; c++)
		segment.from[c] = (double)p->at[side->low][c];
	const uint32_t found = corner_tree_find(&p->tree, &segment, hits, HITS, left);
	for (uint32_t i = 0; i < found; i++) {
		const uint32_t place = hits[i].point;
		if (p->same[place] == place && place != side->low && place != side->high)
			hits[n++] = hits[i];
	}
	qsort(hits, n, sizeof *hits, by_t);
	return n;
}

// What a sort has sorted; its other array is freed.
static struct corner_edge *take_sorted(struct sliced_sort *sort)
{
	struct corner_edge *sorted = sort->items;
	free(sort->spare);
	*sort = (struct sliced_sort){0};
	return sorted;
}

void corner_links_sort(struct corner_links *l, uint32_t count)
{
	sliced_sort_step(&l->sort, count);
	if (!l->sort.done || l->sorted)
		return;
	l->sides = take_sorted(&l->sort);
	l->sorted = true;
}

// Of the sides from the next one on that have its ends.
static void cut_next(struct corner_links *l, uint64_t *left)
{
	struct corner_hit hits[HITS];
	const uint32_t first = l->sides_cut, end = span_end(l->sides, l->side_count, first);
	const struct corner_edge *side = &l->sides[first];
	uint32_t n = find_on(l->places, side, hits, left);
	if ((uint64_t)l->edge_count + (l->side_count - first) + (uint64_t)n * (end - first) > l->edge_most)
		n = 0;
	for (uint32_t i = first; i < end; i++)
		for (uint32_t k = 0; k <= n; k++)
			l->edges[l->edge_count++] = edge_between(k == 0 ? side->low : hits[k - 1].point,
								 k == n ? side->high : hits[k].point, l->sides[i].side);
	l->sides_cut = end;
}

static enum status begin_to_sort_edges(struct corner_links *l, struct error *err)
{
	free(l->sides);
	l->sides = NULL;
	struct corner_edge *spare = malloc(l->edge_count * sizeof *spare + 1);
	if (!spare)
		return error_set(err, STATUS_MEMORY, "out of memory");
	sliced_sort_begin(&l->sort, l->edges, spare, l->edge_count, sizeof *spare, by_ends);
	l->edges = NULL; // the sort's
	return STATUS_OK;
}

enum status corner_links_cut(struct corner_links *l, uint32_t count, uint64_t *left, struct error *err)
{
	if (l->edges) {
		while (l->sides_cut < l->side_count && count-- > 0)
			cut_next(l, left);
		return l->sides_cut == l->side_count ? begin_to_sort_edges(l, err) : STATUS_OK;
	}
	sliced_sort_step(&l->sort, count);
	if (l->sort.done) {
		l->edges = take_sorted(&l->sort);
		l->cut = true;
	}
	return STATUS_OK;
}

// ---- linking ----------------------------------------------------------------------------------------------------------

uint32_t corner_links_same(const struct corner_links *l, uint32_t corner)
{
	while (l->same[corner] != corner)
		corner = l->same[corner];
	return corner;
}

static void side_way(const struct corner_links *l, uint32_t side, double out[3])
{
	way(l->places, l->places->of[side], l->places->of[next_corner(l->places->elements, side)], out);
}

// The corner of a side's patch, 4 patch + 0 … 3, that is in a place; NONE: neither end of the side is.
static uint32_t corner_in(const struct corner_links *l, uint32_t side, uint32_t place)
{
	const uint32_t next = next_corner(l->places->elements, side);
	return l->places->of[side] == place ? side : l->places->of[next] == place ? next : NONE;
}

// Note that a corner in a place lies on a side, if that is the longer one: of two of a length, the first patch's.
static enum status hang(struct corner_links *l, uint32_t corner, uint32_t own, uint32_t side, uint32_t place, uint32_t back,
			struct error *err)
{
	double longer[3], shorter[3], to[3];
	side_way(l, side, longer);
	side_way(l, own, shorter);
	const double long2 = vec3_dot(longer, longer), short2 = vec3_dot(shorter, shorter);
	if (long2 < short2 * (1 - AS_LONG) || (long2 <= short2 * (1 + AS_LONG) && side / 4 > own / 4))
		return STATUS_OK;
	if (l->hang_count == l->hang_most) {
		const uint32_t limit = 4 * HANGS * l->places->elements->patches.count;
		const uint32_t most = l->hang_most < 64 ? 64 : l->hang_most > limit / 2 ? limit : 2 * l->hang_most;
		if (most <= l->hang_most)
			return STATUS_OK;
		struct corner_hang *more = realloc(l->hangs, most * sizeof *more);
		if (!more)
			return error_set(err, STATUS_MEMORY, "out of memory");
		l->hangs = more;
		l->hang_most = most;
	}
	way(l->places, l->places->of[side], place, to);
	l->hangs[l->hang_count++] = (struct corner_hang){
	    corner, side + back, (float)fmin(fmax(vec3_dot(to, longer) / long2, 0), 1), (float)sqrt(long2)};
	return STATUS_OK;
}

// Link two elements across an edge: what is added to a side's number for its back is `back`.
static enum status link(struct corner_links *l, const struct corner_edge *edge, const uint32_t side[2],
			const uint32_t back[2], struct error *err)
{
	const uint32_t ends[2] = {edge->low, edge->high};
	enum status s = STATUS_OK;
	for (int i = 0; i < 2 && s == STATUS_OK; i++) {
		const uint32_t a = corner_in(l, side[0], ends[i]), b = corner_in(l, side[1], ends[i]);
		if (a != NONE && b != NONE)
			union_join(l->same, a + back[0], b + back[1]);
		else if (b != NONE)
			s = hang(l, b + back[1], side[1], side[0], ends[i], back[0], err);
		else if (a != NONE)
			s = hang(l, a + back[0], side[0], side[1], ends[i], back[1], err);
	}
	return s;
}

// Of a side's patch.
static void normal_of(const struct elements *e, uint32_t side, double out[3])
{
	const struct patch_face *face = &e->patches.faces.list[e->shapes[side / 4].face];
	const float *at[4];
	double one[3], two[3];
	for (int k = 0; k < 4; k++)
		at[k] = e->patches.vertices[face->corner[face->corner[k] == NONE ? 0 : k]].position;
	for (int c = 0; c < 3; c++) {
		one[c] = (double)at[2][c] - (double)at[0][c];
		two[c] = (double)at[3][c] - (double)at[1][c];
	}
	vec3_cross(one, two, out);
	vec3_normalize(out);
}

// The direction of an edge: that of its longest side, which knows it best.
static void direction_of(const struct corner_links *l, const struct corner_edge *edges, uint32_t count, double out[3])
{
	double side[3], edge[3];
	side_way(l, edges->side, out);
	for (uint32_t i = 1; i < count; i++) {
		side_way(l, edges[i].side, side);
		const bool longer = vec3_dot(side, side) > vec3_dot(out, out);
		for (int c = 0; c < 3; c++)
			out[c] = longer ? side[c] : out[c];
	}
	way(l->places, edges->low, edges->high, edge);
	const double turn = vec3_dot(edge, out) < 0 ? -1 : 1;
	vec3_normalize(out);
	for (int c = 0; c < 3; c++)
		out[c] *= turn;
}

static int by_angle(const void *a, const void *b)
{
	const struct corner_use *p = a, *q = b;
	if (p->angle != q->angle)
		return p->angle < q->angle ? -1 : 1;
	return p->side < q->side ? -1 : p->side > q->side;
}

static int by_front(const void *a, const void *b)
{
	const struct corner_use *p = a, *q = b;
	if (p->along != q->along)
		return p->along ? 1 : -1;
	return p->side < q->side ? -1 : p->side > q->side;
}

// The patches of an edge by angle; of those that lie on each other, fronts outwards.
static void sort_uses(struct corner_links *l, const struct corner_edge *edges, uint32_t count)
{
	double along[3], first[3] = {0}, second[3] = {0}, normal[3], side[3], in[3];
	direction_of(l, edges, count, along);
	for (uint32_t i = 0; i < count; i++) {
		struct corner_use *use = &l->uses[i];
		side_way(l, edges[i].side, side);
		normal_of(l->places->elements, edges[i].side, normal);
		*use = (struct corner_use){.side = edges[i].side, .along = vec3_dot(side, along) > 0};
		vec3_cross(normal, along, in); // from the edge into the patch, or away from it
		for (int c = 0; c < 3; c++)
			in[c] = use->along ? in[c] : -in[c];
		if (i == 0) {
			for (int c = 0; c < 3; c++)
				first[c] = in[c];
			vec3_cross(along, first, second);
		}
		use->angle = atan2(vec3_dot(in, second), vec3_dot(in, first));
		use->angle += use->angle < -PI + SAME_ANGLE ? 2 * PI : 0;
	}
	qsort(l->uses, count, sizeof *l->uses, by_angle);
	for (uint32_t i = 0, end; i < count; i = end) {
		for (end = i + 1; end < count && l->uses[end].angle - l->uses[end - 1].angle < SAME_ANGLE; end++)
			;
		qsort(l->uses + i, end - i, sizeof *l->uses, by_front);
	}
}

// Two elements that face each other across an angle a have normals π - a apart.
static enum status join_around(struct corner_links *l, const struct corner_edge *edges, uint32_t count, struct error *err)
{
	const uint32_t back = l->places->elements->patches.count * 4;
	const double least = cos(CORNER_CREASE * PI / 180);
	enum status s = STATUS_OK;
	sort_uses(l, edges, count);
	for (uint32_t i = 0; i < count && s == STATUS_OK; i++) {
		const struct corner_use *a = &l->uses[i], *b = &l->uses[i + 1 < count ? i + 1 : 0];
		if (-cos(b->angle - a->angle) >= least)
			s = link(l, edges, (const uint32_t[2]){a->side, b->side},
				 (const uint32_t[2]){a->along ? 0 : back, b->along ? back : 0}, err);
	}
	return s;
}

enum status corner_links_join(struct corner_links *l, uint32_t count, struct error *err)
{
	enum status s = STATUS_OK;
	while (l->edges_joined < l->edge_count && count-- > 0 && s == STATUS_OK) {
		const uint32_t first = l->edges_joined, end = span_end(l->edges, l->edge_count, first);
		if (end - first > 1 && end - first <= USES)
			s = join_around(l, l->edges + first, end - first, err);
		l->edges_joined = end;
	}
	return s;
}
