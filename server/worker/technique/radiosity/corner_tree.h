// Finds the points that lie on a line segment but for rounding: a k-d tree (Bentley 1975, "Multidimensional binary search
// trees used for associative searching") over points that stay where they are. Making it takes O(n log n) whatever the
// points are. Host only, any thread.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_CORNER_TREE_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_CORNER_TREE_H

#include <stdbool.h>
#include <stdint.h>

#include "server/base/error.h"

// A tree.
struct corner_tree {
	const float (*at)[3]; // the caller's points
	uint32_t *order; // points, the middle one of a range divides it
	uint8_t *axis; // along which the point in this place of `order` divides
	uint32_t count;
	struct corner_range {
		uint32_t low, high;
	} waiting[64]; // ranges of `order` that are yet to be divided: at most one more for each halving
	uint32_t waiting_count;
};

// What is looked for: points no further than `reach` from a segment. It may be a point.
struct corner_segment {
	double from[3], along[3]; // it ends at their sum
	double reach;
};

// A point that was found.
struct corner_hit {
	uint32_t point;
	double t; // the nearest place on the segment: 0 where it starts, 1 where it ends
};

// Memory that a tree of so many points takes, in bytes.
uint64_t corner_tree_bytes(uint32_t count);

// Begin the tree of `count` points, which are finite and must outlive it. STATUS_MEMORY. corner_tree_finish frees it.
enum status corner_tree_init(struct corner_tree *tree, const float (*at)[3], uint32_t count, struct error *err);

// Divide ranges of about `points` points in all. True once none is left: now the tree can be used.
bool corner_tree_build(struct corner_tree *tree, uint32_t points);
void corner_tree_finish(struct corner_tree *tree);

// The points that are near a segment, at most `most`, in the order of the tree. Returns their number. *left is how many
// points may still be looked at, and is counted down; once it is 0 none is found. It bounds the time that a scene can cost
// whose points all lie beside all its segments.
uint32_t corner_tree_find(const struct corner_tree *tree, const struct corner_segment *segment, struct corner_hit *hits,
			  uint32_t most, uint64_t *left);

#endif
