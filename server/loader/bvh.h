// Builds a binary BVH over triangles with Embree's builder (surface-area heuristic) and flattens it depth first as blob.h
// describes. One thread.
#ifndef CANDIL_LOADER_BVH_H
#define CANDIL_LOADER_BVH_H

#include <stdint.h>

#include "server/base/error.h"
#include "server/scene/blob.h"

#define BVH_LEAF_TRIANGLES 4u

struct bvh {
	struct bvh_node *nodes; // at least one; owned, as is `order`
	uint32_t node_count;
	uint32_t depth; // number of levels, at most LIMIT_BVH_DEPTH
	uint32_t *order; // triangle ids in leaf order
};

// Build over `count` triangles, which may be 0. Equal input gives equal bits. *out is empty on failure; otherwise it must
// be given to bvh_finish. STATUS_MEMORY, STATUS_INTERNAL.
enum status bvh_build(const struct vertex *vertices, const struct triangle *triangles, uint32_t count, struct bvh *out,
		      struct error *err);

// As bvh_build, without Embree: nodes are split at the median, so that the depth is log2 of the count for every scene.
// bvh_build falls back to it if the tree of the heuristic is too deep.
enum status bvh_build_balanced(const struct vertex *vertices, const struct triangle *triangles, uint32_t count,
			       struct bvh *out, struct error *err);

// Free the arrays.
void bvh_finish(struct bvh *bvh);

#endif
