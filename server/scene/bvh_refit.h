// The boxes of a BVH, from the triangles up: where a loader makes them and where a worker makes them anew after triangles
// moved. Any thread.
#ifndef CANDIL_SCENE_BVH_REFIT_H
#define CANDIL_SCENE_BVH_REFIT_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "server/scene/blob.h"

// A box's face a unit in the last place outside of its triangle. A ray that runs within a face's plane has a distance of 0
// times infinity to it; with the face moved off, a walk that tests the box never misses what a test of the triangle hits, so
// every order of walking finds the same. The least step is for faces at zero, whose neighbours a device may flush.
#define BVH_LEAST_STEP 1e-20f

static inline float bvh_below(float x)
{
	// nextafterf(x, -INFINITY) of what is not zero, without a call: millions of boxes are made while others wait.
	uint32_t bits;
	float next;
	memcpy(&bits, &x, sizeof bits);
	bits = x > 0 ? bits - 1 : bits + 1;
	memcpy(&next, &bits, sizeof next);
	const float least = x - BVH_LEAST_STEP;
	return x != 0 && next < least ? next : least;
}

static inline float bvh_above(float x)
{
	return -bvh_below(-x);
}

// Give the nodes the boxes of these leaf triangles. The tree itself, checked as a blob's, stays as it is; over triangles
// that have not moved every bit stays too.
void bvh_refit(struct bvh_node *nodes, uint32_t node_count, const struct leaf_triangle *leaves);

// What a ray through the whole box costs on average by the surface-area heuristic (Goldsmith and Salmon 1987): boxes tested,
// and triangles in them, each by the chance that a ray through the root meets its box. 0 for a scene without extent.
double bvh_cost(const struct bvh_node *nodes, uint32_t node_count);

#endif
