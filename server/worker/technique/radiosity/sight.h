// What share of each other two elements see, by rays between points of both, on the device. Vulkan; device's thread only.
//
// SIGHT_PROBE rays go between each pair. If nothing stops any of them, the share is 1, exactly; if each is stopped, 0. Only
// where they disagree it is an estimate, from as many rays as the options say: the mean of what is free, weighted by the
// form factor's kernel cos θ1 cos θ2 / r², so that the unobstructed form factor times the share is the form factor. What
// hides less than some SIGHT_PROBE-th of a pair is therefore not seen. A share depends on the scene and the pair alone, and
// is the same for a pair turned round. Where masks or blended surfaces are between two elements, they stop some of the rays.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_SIGHT_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_SIGHT_H

#include "server/worker/technique/radiosity/patch_pass.h"

#define SIGHT_PROBE 32u // rays between each pair
#define SIGHT_RAYS_MOST 65536u
#define SIGHT_PAIRS_MOST 65536u // of a call

struct sight;

// Make ready. `rays`: between a pair that is partly hidden; a multiple of 16, SIGHT_PROBE … SIGHT_RAYS_MOST. What `of` names
// must outlive it. STATUS_BAD_ARGUMENT: another number; STATUS_MEMORY, STATUS_DEVICE. *sight is NULL then.
enum status sight_create(const struct patch_scene *of, uint32_t rays, struct device *device, struct sight **sight,
			 struct error *err);
void sight_destroy(struct sight *sight);

// Compile its code, unless that has been done. It takes seconds on a software device.
bool sight_compiled(const struct sight *sight);
enum status sight_compile(struct sight *sight, struct error *err);

// Where the next call's pairs go, SIGHT_PAIRS_MOST of them: two elements each, in any order.
uint32_t (*sight_pairs(struct sight *sight))[2];

// Find the share[k] that the pair k of the first `count` sees, 0 … 1. STATUS_TRAVERSAL_CUT: the driver ended loops too
// early; STATUS_MEMORY, STATUS_DEVICE.
enum status sight_find(struct sight *sight, uint32_t count, float *share, struct error *err);

// How many pairs take about budget_us, by what those before them took: 1 … SIGHT_PAIRS_MOST.
uint32_t sight_batch(const struct sight *sight, double budget_us);

uint64_t sight_bytes(uint32_t faces, uint32_t rays); // device memory of it, beside the scene's and the elements'

#endif
