#include "server/scene/light_tree.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/angle.h"
#include "server/base/luminance.h"
#include "server/base/vec3.h"

#define BINS 12
#define DEPTH_MAX 31u

// Bounds of the places and directions of lamps: every normal is within `spread` radians of the axis. For a directional
// light, the place is the tip of its direction on the unit sphere.
struct bound {
	double min[3], max[3];
	double power; // π times the most that they emit in a direction: W/sr, directional lights W/m²
	double axis[3];
	double spread; // radians; π: all directions
};

struct lamp {
	struct bound bound;
	double centre[3];
	uint32_t number;
};

struct builder {
	struct light_node *nodes;
	uint32_t *trails; // indexed by emitter
	uint32_t emitter_count;
	uint32_t used; // number of nodes used so far
};

static double clamped_acos(double c)
{
	return acos(c < -1 ? -1 : c > 1 ? 1 : c);
}

// ---- bounds -------------------------------------------------------------------------------------------------------------

// The smallest cone about two cones: Conty Estevez and Kulla, algorithm 1.
static void cone_add(struct bound *to, const struct bound *from)
{
	struct bound wide = to->spread >= from->spread ? *to : *from;
	const struct bound *other = to->spread >= from->spread ? from : to;
	const double apart = clamped_acos(vec3_dot(wide.axis, other->axis));
	if (fmin(apart + other->spread, PI) > wide.spread) {
		const double spread = 0.5 * (wide.spread + apart + other->spread);
		const double turn = spread - wide.spread, s = sin(apart);
		if (spread >= PI || s < 1e-9) {
			wide.spread = PI;
		} else {
			for (int i = 0; i < 3; i++)
				wide.axis[i] = (sin(apart - turn) * wide.axis[i] + sin(turn) * other->axis[i]) / s;
			wide.spread = spread;
		}
	}
	memcpy(to->axis, wide.axis, sizeof to->axis);
	to->spread = wide.spread;
}

static void bound_add(struct bound *to, const struct bound *from)
{
	if (to->power <= 0) {
		*to = *from;
		return;
	}
	for (int i = 0; i < 3; i++) {
		to->min[i] = fmin(to->min[i], from->min[i]);
		to->max[i] = fmax(to->max[i], from->max[i]);
	}
	cone_add(to, from);
	to->power += from->power;
}

// The solid angle that lamps within the cone may light, weighted by the cosine: their equation 1, for surfaces that emit
// into a hemisphere.
static double cone_measure(double spread)
{
	const double w = fmin(spread + PI / 2, PI);
	return 2 * PI * (1 - cos(spread)) +
	       PI / 2 * (2 * w * sin(spread) - cos(spread - 2 * w) - 2 * spread * sin(spread) + cos(spread));
}

// The expected cost, in noise, of choosing among a node's lamps: their equation 2 without its regularising factor.
static double bound_cost(const struct bound *b)
{
	const double d[3] = {b->max[0] - b->min[0], b->max[1] - b->min[1], b->max[2] - b->min[2]};
	const double area = d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
	// Lamps in a line have no area, but their length still counts.
	const double length = d[0] + d[1] + d[2];
	return b->power * (area + 1e-3 * length * length) * cone_measure(b->spread);
}

static struct lamp emitter_lamp(const struct light_tree_lamps *in, uint32_t number)
{
	const struct triangle *t = &in->triangles[in->emitters[number].triangle];
	const struct material *m = &in->materials[t->material];
	const bool both = m->flags & MATERIAL_EMITS_BOTH_SIDES;
	struct lamp l = {.bound.spread = both ? PI : 0, .number = number};
	const float *p[3];
	double n[3];
	for (int c = 0; c < 3; c++)
		p[c] = in->vertices[t->vertex[c]].position;
	for (int i = 0; i < 3; i++) {
		l.bound.min[i] = fmin((double)p[0][i], fmin((double)p[1][i], (double)p[2][i]));
		l.bound.max[i] = fmax((double)p[0][i], fmax((double)p[1][i], (double)p[2][i]));
		l.centre[i] = 0.5 * (l.bound.min[i] + l.bound.max[i]);
	}
	vec3_across(p[0], p[1], p[2], n);
	const double area = 0.5 * sqrt(vec3_dot(n, n));
	for (int i = 0; i < 3; i++)
		l.bound.axis[i] = area > 0 ? n[i] / (2 * area) : i == 2;
	const double share = in->grids ? (double)in->grids[number].share : 1;
	l.bound.power = area * (double)m->power_density * share / (both ? 2 : 1);
	return l;
}

// A spot light is like a small lamp that faces its direction: it emits nothing backwards.
static struct lamp light_lamp(const struct light_tree_lamps *in, uint32_t i)
{
	const struct punctual_light *light = &in->lights[i];
	struct lamp l = {.number = in->first_light + i};
	const float *place = light->kind == LIGHT_DIRECTIONAL ? light->direction : light->position;
	for (int k = 0; k < 3; k++) {
		l.bound.min[k] = l.bound.max[k] = l.centre[k] = place[k];
		l.bound.axis[k] = light->kind == LIGHT_POINT ? k == 2 : (double)light->direction[k];
	}
	l.bound.spread = light->kind == LIGHT_SPOT          ? 0
			 : light->kind == LIGHT_DIRECTIONAL ? acos(1 - (double)light->spread)
							    : PI;
	l.bound.power = PI * luminance(light->intensity);
	return l;
}

// ---- the split ----------------------------------------------------------------------------------------------------------

struct split {
	int axis; // -1: none
	double at;
	double cost;
};

static int compare_lamps(const void *a, const void *b, void *user)
{
	const struct lamp *x = a, *y = b;
	const int axis = *(const int *)user;
	if (x->centre[axis] < y->centre[axis])
		return -1;
	if (x->centre[axis] > y->centre[axis])
		return 1;
	return x->number < y->number ? -1 : 1;
}

static uint32_t bin_of(const struct lamp *l, int axis, double min, double max)
{
	const double at = (l->centre[axis] - min) / (max - min) * BINS;
	return at < BINS - 1 ? (uint32_t)at : BINS - 1;
}

// Find the best split between bins along one axis. The costs prevent a long thin node from being cut along its thin side.
static void try_axis(const struct lamp *lamps, uint32_t count, int axis, const double min[3], const double max[3],
		     struct split *best)
{
	struct bound bins[BINS] = {0}, left[BINS] = {0}, right = {0};
	double longest = 0;
	for (int i = 0; i < 3; i++)
		longest = fmax(longest, max[i] - min[i]);
	if (!(max[axis] > min[axis]))
		return;
	for (uint32_t i = 0; i < count; i++)
		bound_add(&bins[bin_of(&lamps[i], axis, min[axis], max[axis])], &lamps[i].bound);
	for (uint32_t i = 0; i < BINS; i++) {
		left[i] = i > 0 ? left[i - 1] : left[i];
		if (bins[i].power > 0)
			bound_add(&left[i], &bins[i]);
	}
	for (uint32_t i = BINS - 1; i > 0; i--) {
		if (bins[i].power > 0)
			bound_add(&right, &bins[i]);
		const double cost = (bound_cost(&left[i - 1]) + bound_cost(&right)) * longest / (max[axis] - min[axis]);
		if (left[i - 1].power > 0 && right.power > 0 && cost < best->cost)
			*best = (struct split){axis, min[axis] + (max[axis] - min[axis]) * i / BINS, cost};
	}
}

// Move the lamps before the split to the front. Returns their number. The order within each
// part does not matter, but it is always the same.
static uint32_t partition(struct lamp *lamps, uint32_t count, const struct split *split, const double min[3],
			  const double max[3])
{
	const uint32_t first_right =
	    (uint32_t)lround((split->at - min[split->axis]) / (max[split->axis] - min[split->axis]) * BINS);
	uint32_t left = 0;
	for (uint32_t i = 0; i < count; i++) {
		if (bin_of(&lamps[i], split->axis, min[split->axis], max[split->axis]) >= first_right)
			continue;
		const struct lamp swap = lamps[left];
		lamps[left++] = lamps[i];
		lamps[i] = swap;
	}
	return left;
}

// Divide a node's lamps in two parts, neither empty. No more than `half_most` lamps fit under a child.
static uint32_t divide(struct lamp *lamps, uint32_t count, uint32_t half_most)
{
	double min[3], max[3];
	struct split best = {.axis = -1, .cost = INFINITY};
	memcpy(min, lamps[0].centre, sizeof min);
	memcpy(max, lamps[0].centre, sizeof max);
	for (uint32_t i = 1; i < count; i++)
		for (int a = 0; a < 3; a++) {
			min[a] = fmin(min[a], lamps[i].centre[a]);
			max[a] = fmax(max[a], lamps[i].centre[a]);
		}
	for (int axis = 0; axis < 3; axis++)
		try_axis(lamps, count, axis, min, max, &best);
	uint32_t left = best.axis >= 0 ? partition(lamps, count, &best, min, max) : 0;
	if (left == 0 || left == count || left > half_most || count - left > half_most) {
		int longest = 0;
		for (int a = 1; a < 3; a++)
			longest = max[a] - min[a] > max[longest] - min[longest] ? a : longest;
		qsort_r(lamps, count, sizeof *lamps, compare_lamps, &longest);
		left = count / 2;
	}
	return left;
}

// ---- the tree -----------------------------------------------------------------------------------------------------------

// Bounds that contain nothing mark the nodes of directional lights.
static void put_node(struct light_node *n, const struct bound *b, bool far)
{
	for (int i = 0; i < 3; i++) {
		n->min[i] = far ? 1.0f : (float)b->min[i];
		n->max[i] = far ? -1.0f : (float)b->max[i];
		n->axis[i] = (float)b->axis[i];
	}
	n->power = (float)fmax(FLT_MIN, fmin(b->power, 1e37)); // only ratios of powers count
	n->cos_spread = (float)(cos(b->spread) - 1e-6); // rounding must not exclude a lamp
}

static void build(struct builder *b, uint32_t node, struct lamp *lamps, uint32_t count, bool far, uint32_t trail,
		  uint32_t depth)
{
	struct bound all = {0};
	for (uint32_t i = 0; i < count; i++)
		bound_add(&all, &lamps[i].bound);
	put_node(&b->nodes[node], &all, far);
	if (count == 1) {
		b->nodes[node].child = LIGHT_LEAF | lamps->number;
		if (lamps->number < b->emitter_count)
			b->trails[lamps->number] = trail;
		return;
	}
	const uint32_t half_most = 1u << (DEPTH_MAX - depth - 1);
	const uint32_t left = divide(lamps, count, half_most), child = b->used;
	b->nodes[node].child = child;
	b->used += 2;
	build(b, child, lamps, left, far, trail, depth + 1);
	build(b, child + 1, lamps + left, count - left, far, trail | 1u << depth, depth + 1);
}

// List local lamps from the front and directional lights from the back. Returns the number of local lamps.
static uint32_t list_lamps(const struct light_tree_lamps *in, struct lamp *lamps)
{
	uint32_t near = 0, far = in->emitter_count + in->light_count;
	for (uint32_t i = 0; i < in->emitter_count; i++)
		lamps[near++] = emitter_lamp(in, i);
	for (uint32_t i = 0; i < in->light_count; i++)
		lamps[in->lights[i].kind == LIGHT_DIRECTIONAL ? --far : near++] = light_lamp(in, i);
	return near;
}

enum status light_tree_build(const struct light_tree_lamps *in, struct light_node *nodes, uint32_t *trails,
			     struct error *err)
{
	const uint32_t count = in->emitter_count + in->light_count;
	struct lamp *lamps = malloc(count * sizeof *lamps);
	struct builder b = {.nodes = nodes, .trails = trails, .emitter_count = in->emitter_count, .used = 1};
	if (!lamps)
		return error_set(err, STATUS_MEMORY, "no memory for a tree of %u lamps", count);
	const uint32_t near = list_lamps(in, lamps);
	if (near == 0 || near == count) {
		build(&b, 0, lamps, count, near == 0, 0, 0);
	} else {
		// Nobody reads the root's own bounds.
		nodes[0] = (struct light_node){.power = 1, .cos_spread = -1, .axis = {0, 0, 1}, .child = 1};
		b.used = 3;
		build(&b, 1, lamps, near, false, 0, 1);
		build(&b, 2, lamps + near, count - near, true, 1, 1);
	}
	free(lamps);
	return STATUS_OK;
}
