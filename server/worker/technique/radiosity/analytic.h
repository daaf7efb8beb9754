// Form factors of elements by contour integrals (form_factor.h), times the share of each other that they see (sight.h):
// rows of them. Without mirrors. Vulkan; device's thread only.
//
// An entry of a row is F_ij = A F(i, j) · share / A_i. Which of three a pair is, is decided by SIGHT_PROBE rays between it:
// - none is stopped: the share is 1, and the entry has no noise. Its relative error is at most 1e-6, of which the float that
//   it is stored as has 6e-8. Elements of which one is in front of the other's plane by no more than the rounding of
//   corners have less than ANALYTIC_ENOUGH, or nothing.
// - all are: there is no entry.
// - some are: the share is estimated by more rays, and the entry has their error.
// Pairs of which one is behind the other's plane have no entry, and no rays.
//
// A row takes as many pairs as there are elements: this is for small scenes and for judging other ways. Its bits depend on
// the scene and the options alone.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_ANALYTIC_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_ANALYTIC_H

#include "server/worker/technique/radiosity/factors.h"
#include "server/worker/technique/radiosity/sight.h"

#define ANALYTIC_ENOUGH 1e-12 // of the area of the smaller element: form_factor_exchange's `enough`

struct analytic;

// Make ready. `rays`: between a pair that is partly hidden, as sight_create. What `of` names must outlive it. Fails as
// sight_create; *analytic is NULL then.
enum status analytic_create(const struct patch_scene *of, uint32_t rays, struct device *device, struct analytic **analytic,
			    struct error *err);
void analytic_destroy(struct analytic *analytic);

// Compile its code, unless that has been done. It takes seconds on a software device.
bool analytic_compiled(const struct analytic *analytic);
enum status analytic_compile(struct analytic *analytic, struct error *err);

// Begin the row of an element. One that was begun before and is not finished is forgotten.
void analytic_begin(struct analytic *analytic, uint32_t element);

// Work on it for about budget_us, at least one batch of pairs. With the last the row is put into `factors`: `escaped` is
// what its sum is short of 1. Fails as sight_find and factors_put_row.
enum status analytic_step(struct analytic *analytic, uint32_t budget_us, struct factors *factors, struct error *err);
bool analytic_finished(const struct analytic *analytic); // no row is begun

uint64_t analytic_bytes(uint32_t faces, uint32_t rays); // device memory of it, beside the scene's and the elements'

#endif
