// The boxes of a BVH, computed from its triangles: when a loader builds them, and when a worker renews them after triangles
// have moved. Any thread; cannot fail.
#ifndef CANDIL_SCENE_BVH_REFIT_H
#define CANDIL_SCENE_BVH_REFIT_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "server/scene/blob.h"

// A box's faces lie one unit in the last place outside of its triangles. For a ray that runs within the plane of a face,
// the distance to it would be 0 times infinity. With the face moved outwards, a walk that tests the box never misses what a
// test of the triangle hits, so the result does not depend on the order of walking. The least step is for faces at zero,
// whose neighbouring floats a device may flush to zero.
#define BVH_LEAST_STEP 1e-20f

static inline float bvh_below(float x)
{
	// The same as nextafterf(x, -INFINITY) for x other than zero, but without a call: a job may wait for millions of
	// boxes.
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

// Recompute the boxes of the nodes from these leaf triangles. The tree must be that of a checked blob and does not change.
// If no triangle has moved, no bit changes.
void bvh_refit(struct bvh_node *nodes, uint32_t node_count, const struct leaf_triangle *leaves);

// The average cost of a ray through the root's box by the surface-area heuristic (Goldsmith and Salmon 1987): the number of
// boxes and triangles tested, each weighted by the probability that the ray meets its box. 0 for a scene without extent.
double bvh_cost(const struct bvh_node *nodes, uint32_t node_count);

#endif
