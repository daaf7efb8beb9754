// The inside of corners.h, for corners.c and corner_values.c.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_CORNERS_PARTS_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_CORNERS_PARTS_H

#include "server/worker/technique/radiosity/corner_links.h"
#include "server/worker/technique/radiosity/corners.h"

// What is done next.
enum corner_stage { LIST, FIND, WELD, LINK, SORT, CUT, JOIN, GROUP, MEASURE, FINISHED };

// Which corners belong together, and how far it is.
struct corners {
	const struct elements *elements;
	enum corner_stage stage;
	struct corner_places places;
	struct corner_links links;
	uint64_t left; // points that may be looked at
	float *angle; // by patch corner, radians
	float (*middle)[3]; // by patch, metres
	uint32_t measured; // patches
	uint32_t *group; // by element corner; NONE: a triangle's fourth
	uint32_t groups;
	uint32_t *first; // by group, and one more: its first member
	uint32_t *members; // element corners
	float (*at)[3]; // by group, metres
	struct corner_hang *hangs; // the longest sides first; their `corner` is still one of an element
	uint32_t hang_count;
};

// The number of elements' corners.
static inline uint32_t corners_of(const struct elements *e)
{
	return 4 * e->count;
}

#endif
