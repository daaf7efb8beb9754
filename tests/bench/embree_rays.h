// Embree's rays and the time, for benchmarks that measure a traversal beside it.
#ifndef CANDIL_TESTS_EMBREE_RAYS_H
#define CANDIL_TESTS_EMBREE_RAYS_H

#include <embree3/rtcore.h>
#include <stdbool.h>
#include <stdint.h>

#include "shaders/shared/cast.h"

// How many processors there are, at most EMBREE_THREADS.
#define EMBREE_THREADS 64u
uint32_t bench_processors(void);

// Time in µs from some moment on: the wall clock's, or what this process' processors spent, divided by their number.
double bench_us(bool by_processor);

// Trace rays in their order, on as many threads as there are processors, `width` (8 or 16) at a time; those beyond a
// multiple of it are left out. `any`: any hit will do. *hits is how many hit.
void embree_rays(RTCScene scene, const struct cast_ray *rays, uint32_t count, uint32_t width, bool any, uint32_t *hits);

#endif
