// What a plan of radiosity asks for: options of the solution and of its picture, the device memory that both take, and what
// is said of it beforehand. Nothing of it works on a scene. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_PLAN_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_PLAN_H

#include "server/worker/plan/plan.h"
#include "server/worker/technique/radiosity/display.h"
#include "server/worker/technique/radiosity/solution.h"

// Fill in what the solution depends on, and what its picture does.
void radiosity_solution_options(const struct plan *plan, const struct resident_scene *scene,
				struct solution_options *options);
struct display_options radiosity_display_options(const struct plan *plan, const struct resident_scene *scene);

// How many patches there will be, about.
double radiosity_patches_guess(const struct plan *plan, struct resident_scene *scene);

// struct technique's functions of the same names.
uint64_t radiosity_bytes(const struct devices *devices, struct resident_scene *scene, const struct plan *plan);
void radiosity_advise(const struct devices *devices, struct resident_scene *scene, const struct plan *plan, uint64_t budget,
		      char *advice);
uint32_t radiosity_depth(const struct plan *plan);
const char *radiosity_cannot(const struct plan *plan, candil_Effect effect);
const char *radiosity_simulates(const struct plan *plan, candil_Effect effect);
void radiosity_notes(const struct resident_scene *scene, const struct plan *plan, candil_Accepted *accepted);

#endif
