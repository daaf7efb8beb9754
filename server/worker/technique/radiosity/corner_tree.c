#include "server/worker/technique/radiosity/corner_tree.h"

#include <math.h>
#include <stdlib.h>

#include "server/base/vec3.h"

#define LEAF 8u // points that are looked at one by one
#define PATIENCE 8u // of a selection: it may look at as many times its points before they are sorted instead

// ---- making -----------------------------------------------------------------------------------------------------------

struct by_axis {
	const float (*at)[3];
	int axis;
};

static int compare(const void *a, const void *b, void *context)
{
	const struct by_axis *by = context;
	const float p = by->at[*(const uint32_t *)a][by->axis], q = by->at[*(const uint32_t *)b][by->axis];
	return p < q ? -1 : p > q;
}

static float middle(float a, float b, float c)
{
	return fmaxf(fminf(a, b), fminf(fmaxf(a, b), c));
}

static void swap(uint32_t *a, uint32_t *b)
{
	const uint32_t t = *a;
	*a = *b;
	*b = t;
}

// Order the range low … high - 1 so that what is before `mid` is not above it, and what is after not below.
static void divide(struct corner_tree *t, uint32_t low, uint32_t high, uint32_t mid, int axis)
{
	uint32_t *o = t->order;
	struct by_axis by = {t->at, axis};
	const uint64_t most = (uint64_t)(high - low) * PATIENCE;
	for (uint64_t work = 0; high - low > 1; work += high - low) {
		if (work > most) {
			qsort_r(o + low, high - low, sizeof *o, compare, &by);
			return;
		}
		const float pivot =
		    middle(t->at[o[low]][axis], t->at[o[low + (high - low) / 2]][axis], t->at[o[high - 1]][axis]);
		uint32_t below = low, i = low, above = high; // below the pivot: up to `below`; above it: from `above` on
		while (i < above) {
			const float value = t->at[o[i]][axis];
			if (value < pivot)
				swap(&o[below++], &o[i++]);
			else if (value > pivot)
				swap(&o[--above], &o[i]);
			else
				i++;
		}
		if (mid < below)
			high = below;
		else if (mid >= above)
			low = above;
		else
			return;
	}
}

static int longest_axis(const struct corner_tree *t, uint32_t low, uint32_t high)
{
	float least[3] = {INFINITY, INFINITY, INFINITY}, most[3] = {-INFINITY, -INFINITY, -INFINITY};
	for (uint32_t i = low; i < high; i++)
		for (int c = 0; c < 3; c++) {
			least[c] = fminf(least[c], t->at[t->order[i]][c]);
			most[c] = fmaxf(most[c], t->at[t->order[i]][c]);
		}
	int axis = 0;
	for (int c = 1; c < 3; c++)
		axis = most[c] - least[c] > most[axis] - least[axis] ? c : axis;
	return axis;
}

bool corner_tree_build(struct corner_tree *t, uint32_t points)
{
	for (uint32_t divided = 0; t->waiting_count > 0 && divided < points;) {
		const struct corner_range r = t->waiting[--t->waiting_count];
		if (r.high - r.low <= LEAF)
			continue;
		const uint32_t mid = r.low + (r.high - r.low) / 2;
		const int axis = longest_axis(t, r.low, r.high);
		divide(t, r.low, r.high, mid, axis);
		t->axis[mid] = (uint8_t)axis;
		t->waiting[t->waiting_count++] = (struct corner_range){mid + 1, r.high};
		t->waiting[t->waiting_count++] = (struct corner_range){r.low, mid};
		divided += r.high - r.low;
	}
	return t->waiting_count == 0;
}

uint64_t corner_tree_bytes(uint32_t count)
{
	return (uint64_t)count * (sizeof(uint32_t) + sizeof(uint8_t)) + 2;
}

enum status corner_tree_init(struct corner_tree *t, const float (*at)[3], uint32_t count, struct error *err)
{
	*t = (struct corner_tree){.at = at, .count = count};
	t->order = malloc(count * sizeof *t->order + 1);
	t->axis = malloc(count * sizeof *t->axis + 1);
	if (!t->order || !t->axis) {
		corner_tree_finish(t);
		return error_set(err, STATUS_MEMORY, "out of memory");
	}
	for (uint32_t i = 0; i < count; i++)
		t->order[i] = i;
	t->waiting[t->waiting_count++] = (struct corner_range){0, count};
	return STATUS_OK;
}

void corner_tree_finish(struct corner_tree *t)
{
	free(t->order);
	free(t->axis);
	*t = (struct corner_tree){0};
}

// ---- looking ----------------------------------------------------------------------------------------------------------

struct search {
	const struct corner_tree *tree;
	const struct corner_segment *segment;
	struct corner_hit *hits;
	uint32_t found, most;
	uint64_t left; // points that may still be looked at
};

static void look_at(struct search *s, uint32_t point)
{
	const struct corner_segment *g = s->segment;
	if (s->left == 0)
		return;
	s->left--;
	double to[3], square = vec3_dot(g->along, g->along), off = 0;
	for (int c = 0; c < 3; c++)
		to[c] = (double)s->tree->at[point][c] - g->from[c];
	const double t = square > 0 ? fmin(fmax(vec3_dot(to, g->along) / square, 0), 1) : 0;
	for (int c = 0; c < 3; c++)
		off += (to[c] - t * g->along[c]) * (to[c] - t * g->along[c]);
	if (off <= g->reach * g->reach && s->found < s->most)
		s->hits[s->found++] = (struct corner_hit){point, t};
}

// Look in a range for what is near the part t0 … t1 of the segment.
static void look(struct search *s, uint32_t low, uint32_t high, double t0, double t1)
{
	const struct corner_tree *t = s->tree;
	const struct corner_segment *g = s->segment;
	if (s->left == 0)
		return;
	if (high - low <= LEAF) {
		for (uint32_t i = low; i < high; i++)
			look_at(s, t->order[i]);
		return;
	}
	const uint32_t mid = low + (high - low) / 2;
	const int axis = t->axis[mid];
	const double wall = (double)t->at[t->order[mid]][axis], along = g->along[axis];
	const double a = g->from[axis] + t0 * along, b = g->from[axis] + t1 * along;
	// Where the segment is `reach` beyond the wall on either side.
	const double enter = along != 0 ? (wall - g->reach - g->from[axis]) / along : 0,
		     leave = along != 0 ? (wall + g->reach - g->from[axis]) / along : 0;
	look_at(s, t->order[mid]);
	if (fmin(a, b) - g->reach <= wall)
		look(s, low, mid, along < 0 ? fmax(t0, leave) : t0, along > 0 ? fmin(t1, leave) : t1);
	if (fmax(a, b) + g->reach >= wall)
		look(s, mid + 1, high, along > 0 ? fmax(t0, enter) : t0, along < 0 ? fmin(t1, enter) : t1);
}

uint32_t corner_tree_find(const struct corner_tree *tree, const struct corner_segment *segment, struct corner_hit *hits,
			  uint32_t most, uint64_t *left)
{
	struct search s = {.tree = tree, .segment = segment, .hits = hits, .most = most, .left = *left};
	look(&s, 0, tree->count, 0, 1);
	*left = s.left;
	return s.found;
}
