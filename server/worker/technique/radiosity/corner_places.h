// The places where the corners of patches are. Corners in one place but for the rounding of floats share a place, also those
// of different faces. How much that is depends on how far from the origin a corner's face reaches, as for the flatness of a
// face (patch_faces.c), so that a sky far away makes nothing coarse. Host only, any thread.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_CORNER_PLACES_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_CORNER_PLACES_H

#include "server/worker/technique/radiosity/corner_tree.h"
#include "server/worker/technique/radiosity/elements.h"
#include "server/worker/technique/radiosity/sliced_sort.h"

// All places of a scene.
struct corner_places {
	const struct elements *elements;
	struct sliced_sort sort; // of the corners, until they are found
	bool found;
	float (*at)[3]; // metres, by place
	float *reach; // metres, by place: how far another may be that is the same
	uint32_t *same; // by place: one that stands for it and for all that are the same; itself for most
	uint32_t *of; // by corner, 4 patch + 0 … 3: the place that stands for its place; NONE: a triangle's fourth
	uint32_t count;
	uint32_t welded; // places that have been compared
	struct corner_tree tree; // of all places
};

// Memory for so many patches, in bytes, at most, and while it is made.
uint64_t corner_places_bytes(uint32_t patches);

// Begin. `elements` must outlive the places, which corner_places_finish frees. STATUS_MEMORY: nothing is left.
enum status corner_places_init(struct corner_places *places, const struct elements *elements, struct error *err);

// Sort about `count` more corners by where they are; when all are, number their places, and `found` is true. They are not
// yet compared with each other. STATUS_MEMORY.
enum status corner_places_find(struct corner_places *places, uint32_t count, struct error *err);

// Compare as many more places with those near them; once all are, `of` says what the header promises. *left is as for
// corner_tree_find. A place of which too many are near is the same as the first of them.
void corner_places_weld(struct corner_places *places, uint32_t count, uint64_t *left);

// How far from a side of a patch a corner may be that is on it, in metres.
double corner_places_reach(const struct corner_places *places, uint32_t patch);

// Free them. Places that are all zero are fine.
void corner_places_finish(struct corner_places *places);

#endif
