// Internal to deferred.h: an estimate of what drawing some triangles costs. Host only, any thread.
#ifndef CANDIL_WORKER_TECHNIQUE_DEFERRED_COVER_H
#define CANDIL_WORKER_TECHNIQUE_DEFERRED_COVER_H

#include "server/worker/plan/plan.h"
#include "server/worker/scenes/resident.h"

// Cost of a triangle that covers no pixel, in pixels.
#define DEFERRED_TRIANGLE_COST 16.0

// How many of the `count` triangles from `first` on can be drawn over rows [first_row, first_row + rows) of the plan's
// picture for at most *cost pixels, but at least one if there is one. A triangle costs DEFERRED_TRIANGLE_COST and the pixels
// of the box around its visible part. Sets *cost to what those triangles cost.
uint32_t deferred_drawable(const struct plan *plan, const struct resident_scene *scene, uint32_t first_row, uint32_t rows,
			   uint32_t first, uint32_t count, double *cost);

#endif
