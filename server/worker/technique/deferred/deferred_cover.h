// Inside deferred.h: how much drawing some triangles is. Host only; no device is asked.
#ifndef CANDIL_WORKER_TECHNIQUE_DEFERRED_COVER_H
#define CANDIL_WORKER_TECHNIQUE_DEFERRED_COVER_H

#include "server/worker/plan/plan.h"
#include "server/worker/scenes/resident.h"

// Cost of a triangle that covers nothing, in pixels.
#define DEFERRED_TRIANGLE_COST 16.0

// How many of `count` triangles from `first` on can be drawn over rows [first_row, first_row + rows) of the plan's picture
// for *cost at most: DEFERRED_TRIANGLE_COST each, and the pixels of the box around what is seen of it. At least one, if
// there is one. *cost is then what they come to.
uint32_t deferred_drawable(const struct plan *plan, const struct resident_scene *scene, uint32_t first_row, uint32_t rows,
			   uint32_t first, uint32_t count, double *cost);

#endif
