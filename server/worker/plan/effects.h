// What becomes of every effect (simulated, left out, switched off, forced on, or beyond the technique), and the sentence
// that tells why. Host only, any thread.
#ifndef CANDIL_WORKER_PLAN_EFFECTS_H
#define CANDIL_WORKER_PLAN_EFFECTS_H

#include "server/scene/blob.h"
#include "server/worker/plan/plan.h"
#include "server/worker/technique/technique.h"

// Fill in plan->effects and plan->reports, and give default light where it is asked for and needed. The rest of the plan is
// set before, above all its depth and environment. `scene` has its edits. Does not fail.
void plan_effects(const candil_Render *request, const struct blob_view *scene, const struct technique *technique,
		  struct plan *plan);

// List the techniques whose surfaces take light from a background, with their default options: "pt or vct".
void effects_list_lit_by_background(char *out, size_t capacity);

#endif
