// A binary BVH over triangles, by Embree's builder (surface-area heuristic), flattened depth first as blob.h says.
#ifndef CANDIL_LOADER_BVH_H
#define CANDIL_LOADER_BVH_H

#include <stdint.h>

#include "server/base/error.h"
#include "server/scene/blob.h"

#define BVH_LEAF_TRIANGLES 4u

struct bvh {
	struct bvh_node *nodes; // at least one
	uint32_t node_count;
	uint32_t depth; // levels, ≤ LIMIT_BVH_DEPTH
	uint32_t *order; // triangle ids in leaf order
};

// Build over `count` triangles, which may be 0. The same input gives the same bits. STATUS_MEMORY, STATUS_INTERNAL.
enum status bvh_build(const struct vertex *vertices, const struct triangle *triangles, uint32_t count, struct bvh *out,
		      struct error *err);

// The same without Embree: cut at the median, so that the depth is log2 whatever the scene. bvh_build turns to it where the
// heuristic's tree is too deep.
enum status bvh_build_balanced(const struct vertex *vertices, const struct triangle *triangles, uint32_t count,
			       struct bvh *out, struct error *err);

void bvh_finish(struct bvh *bvh);

#endif
