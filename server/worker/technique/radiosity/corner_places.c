#include "server/worker/technique/radiosity/corner_places.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/worker/technique/radiosity/union_find.h"

#define SAME (4 * FLT_EPSILON) // of the largest coordinate of a face: what two roundings and a matrix may move a corner by
#define NEAR 64u // places near one that are compared with it

// A corner, where it is, and how far another may be that is in the same place.
struct point {
	float at[3];
	float reach;
	uint32_t corner;
};

static int by_place(const void *a, const void *b)
{
	const struct point *p = a, *q = b;
	for (int c = 0; c < 3; c++)
		if (p->at[c] != q->at[c])
			return p->at[c] < q->at[c] ? -1 : 1;
	return p->corner < q->corner ? -1 : p->corner > q->corner;
}

double corner_places_reach(const struct corner_places *p, uint32_t patch)
{
	const struct patches *patches = &p->elements->patches;
	const struct patch_face *face = &patches->faces.list[p->elements->shapes[patch].face];
	double most = 0;
	for (uint32_t k = 0; k < 4 && face->corner[k] != NONE; k++)
		for (int c = 0; c < 3; c++)
			most = fmax(most, fabs((double)patches->vertices[face->corner[k]].position[c]));
	return SAME * most;
}

static uint32_t list_points(struct corner_places *p, struct point *points)
{
	const struct elements *e = p->elements;
	uint32_t n = 0;
	for (uint32_t i = 0; i < e->patches.count; i++) {
		const struct radiosity_patch *patch = &e->shapes[i];
		const uint32_t corners = e->faces[patch->face].v ? 4 : 3;
		const float reach = (float)corner_places_reach(p, i);
		p->of[4 * i + 3] = NONE;
		for (uint32_t k = 0; k < corners; k++, n++) {
			points[n].corner = 4 * i + k;
			points[n].reach = reach;
			for (uint32_t c = 0; c < 3; c++)
				points[n].at[c] = patch->corner[3 * k + c] + 0.0f; // -0 becomes 0
		}
	}
	return n;
}

static bool is_new(const struct point *points, uint32_t i)
{
	return i == 0 || memcmp(points[i].at, points[i - 1].at, sizeof points[i].at) != 0;
}

// Number the places of sorted corners.
static enum status number_places(struct corner_places *p, const struct point *points, uint32_t n, struct error *err)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < n; i++)
		count += is_new(points, i);
	// An attempt without enough memory may have left some.
	free(p->at);
	free(p->reach);
	free(p->same);
	p->count = 0;
	p->at = malloc(count * sizeof *p->at + 1);
	p->reach = malloc(count * sizeof *p->reach + 1);
	p->same = malloc(count * sizeof *p->same + 1);
	if (!p->at || !p->reach || !p->same) {
		free(p->at);
		free(p->reach);
		free(p->same);
		p->at = NULL;
		p->reach = NULL;
		p->same = NULL;
		return error_set(err, STATUS_MEMORY, "out of memory");
	}
	for (uint32_t i = 0; i < n; i++) {
		if (is_new(points, i)) {
			memcpy(p->at[p->count], points[i].at, sizeof points[i].at);
			p->same[p->count] = p->count;
			p->reach[p->count++] = 0;
		}
		const uint32_t place = p->count - 1;
		p->of[points[i].corner] = place;
		p->reach[place] = fmaxf(p->reach[place], points[i].reach);
	}
	return corner_tree_init(&p->tree, (const float(*)[3])p->at, p->count, err);
}

uint64_t corner_places_bytes(uint32_t patches)
{
	const uint64_t corners = 4 * (uint64_t)patches;
	return corners * (2 * sizeof(struct point) + 6 * sizeof(float)) + 4 * corner_tree_bytes(patches) + 6;
}

enum status corner_places_init(struct corner_places *p, const struct elements *elements, struct error *err)
{
	const uint64_t corners = 4 * (uint64_t)elements->patches.count;
	*p = (struct corner_places){.elements = elements};
	struct point *points = malloc(corners * sizeof *points + 1), *spare = malloc(corners * sizeof *spare + 1);
	p->of = malloc(corners * sizeof *p->of + 1);
	if (!points || !spare || !p->of) {
		free(points);
		free(spare);
		corner_places_finish(p);
		return error_set(err, STATUS_MEMORY, "out of memory");
	}
	sliced_sort_begin(&p->sort, points, spare, list_points(p, points), sizeof *points, by_place);
	return STATUS_OK;
}

static void free_sort(struct corner_places *p)
{
	free(p->sort.items);
	free(p->sort.spare);
	p->sort = (struct sliced_sort){0};
}

enum status corner_places_find(struct corner_places *p, uint32_t count, struct error *err)
{
	if (p->at) {
		p->found = corner_tree_build(&p->tree, count);
		return STATUS_OK;
	}
	sliced_sort_step(&p->sort, count);
	if (!p->sort.done)
		return STATUS_OK;
	const enum status s = number_places(p, p->sort.items, p->sort.count, err);
	if (s == STATUS_OK)
		free_sort(p);
	return s;
}

void corner_places_weld(struct corner_places *p, uint32_t count, uint64_t *left)
{
	struct corner_hit hits[NEAR];
	for (; p->welded < p->count && count > 0; p->welded++, count--) {
		const uint32_t i = p->welded;
		struct corner_segment here = {.reach = (double)p->reach[i]};
		for (int c = 0; c < 3; c++)
			here.from[c] = (double)p->at[i][c];
		const uint32_t found = corner_tree_find(&p->tree, &here, hits, NEAR, left);
		for (uint32_t k = 0; k < found; k++)
			union_join(p->same, i, hits[k].point);
	}
	if (p->welded < p->count)
		return;
	for (uint32_t i = 0; i < p->count; i++)
		p->same[i] = union_find(p->same, i);
	for (uint64_t i = 0; i < 4 * (uint64_t)p->elements->patches.count; i++)
		p->of[i] = p->of[i] == NONE ? NONE : p->same[p->of[i]];
}

void corner_places_finish(struct corner_places *p)
{
	free_sort(p);
	corner_tree_finish(&p->tree);
	free(p->of);
	free(p->same);
	free(p->reach);
	free(p->at);
	*p = (struct corner_places){0};
}
