// From a checked request and a scene to a plan. Host only, any thread.
#ifndef CANDIL_WORKER_PLAN_MAKE_H
#define CANDIL_WORKER_PLAN_MAKE_H

#include "server/base/error.h"
#include "server/scene/blob.h"
#include "server/worker/plan/plan.h"

// Plan a request over a scene, and the surroundings that it names (NULL: none), whose resident scene is left to be filled
// in. STATUS_BAD_ARGUMENT for an option or a camera that does not exist or cannot be, and for surroundings that are none;
// STATUS_LIMIT for an option beyond its most; STATUS_UNSUPPORTED for a technique that this worker does not have.
enum status plan_make(const candil_Render *request, const struct blob_view *scene, const struct blob_header *environment,
		      struct plan *plan, struct error *err);

#endif
