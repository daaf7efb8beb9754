// Tries out some of what a solution is made of, for prospect.c alone: elements, a look at light, and rows from all over the
// scene. All of it is thrown away. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_PROSPECT_TRY_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_PROSPECT_TRY_H

#include "server/worker/technique/radiosity/factor_build.h"
#include "server/worker/technique/radiosity/light.h"

struct devices;

// What is tried out.
struct prospect_try {
	struct devices *devices;
	struct resident_scene *scene;
	const struct plan *plan;
	const struct factor_options *factors;
	const struct light_options *light;
	bool background; // an even one lights whatever sees it
	bool rows; // rows are tried, too
};

// What was found. Times are microseconds.
struct prospect_found {
	uint32_t elements; // of the scene; 0: it has no surface
	double cut, cut_us; // elements that were gone through, and how long that took
	double rays, light_us; // rays to lights
	double rows, rows_us; // rows that were made against the clock; 0: none
	double wanted; // elements that light reaches, about
	double doubt; // deviation of its logarithm
	double entries; // of a row, in the mean
};

// Try for about budget_us, beside compiling and the cutting of the scene. Fails as solution_acquire and solution_step.
enum status prospect_run(const struct prospect_try *of, uint32_t budget_us, struct prospect_found *found, struct error *err);

#endif
