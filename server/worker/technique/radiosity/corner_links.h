// Which corners of elements are one corner of a smooth surface, and which lie on the side of a larger element.
//
// Around an edge, the patches that have it are sorted by their angles, and two elements that face each other across the
// space between two neighbours are linked where their normals are no further apart than CORNER_CREASE. So a floor goes on
// beneath a wall that ends on it only where there is no wall, a surface that is there twice keeps its two outer sides, and
// neighbours whose corners run in opposite directions are linked front to back. Edges are cut at all corners that lie on
// them, so that elements of different sizes find each other. Host only, any thread.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_CORNER_LINKS_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_CORNER_LINKS_H

#include "server/worker/technique/radiosity/corner_places.h"

// The largest angle between the normals of neighbours that count as one smooth surface, in degrees: somewhat more than 30,
// so that a round body of 12 sides is smooth. The edges of a room and of a prism of fewer sides are not.
#define CORNER_CREASE 31.0

// A side of a patch, or a part of one, between two places, the lower first.
struct corner_edge {
	uint32_t low, high;
	uint32_t side; // 4 patch + the corner where it begins
};

// A corner that lies on a side of a linked element and is no corner of it.
struct corner_hang {
	uint32_t corner; // 4 element + 0 … 3
	uint32_t side; // 4 element + the corner where it begins
	float t; // from there, 0…1
	float length; // of the side, metres
};

// All links of a scene, while they are made and after.
struct corner_links {
	const struct corner_places *places;
	struct sliced_sort sort; // of the sides of all patches, then of their parts
	struct corner_edge *sides; // sorted; NULL once all are cut
	uint32_t side_count, sides_cut;
	struct corner_edge *edges; // their parts, sorted once `cut` is true
	uint32_t edge_count, edge_most, edges_joined;
	bool sorted, cut;
	uint32_t *same; // by corner, 4 element + 0 … 3: the way to the one that stands for it
	struct corner_hang *hangs;
	uint32_t hang_count, hang_most;
	struct corner_use *uses; // room for one edge's
};

// Memory for so many patches, in bytes, at most.
uint64_t corner_links_bytes(uint32_t patches);

// Begin with the sides of all patches. `places`, whose places have all been compared, must outlive the links, which
// corner_links_finish frees. STATUS_MEMORY: nothing is left.
enum status corner_links_init(struct corner_links *links, const struct corner_places *places, struct error *err);

// Sort about `count` more sides; when all are, `sorted` is true.
void corner_links_sort(struct corner_links *links, uint32_t count);

// Cut about `count` more sides, once all are sorted, at the corners on them, or sort about as many parts; when all are,
// `cut` is true. *left is as for corner_tree_find. STATUS_MEMORY.
enum status corner_links_cut(struct corner_links *links, uint32_t count, uint64_t *left, struct error *err);

// Link elements across about `count` more edges of those that have been cut, until edges_joined is edge_count.
// STATUS_MEMORY.
enum status corner_links_join(struct corner_links *links, uint32_t count, struct error *err);

// The corner that stands for a corner and all that are linked with it.
uint32_t corner_links_same(const struct corner_links *links, uint32_t corner);

// Free them. Links that are all zero are fine.
void corner_links_finish(struct corner_links *links);

#endif
