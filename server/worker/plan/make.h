// Planning: from a request that has passed the front's check, and a scene, to a plan. Host only, any thread.
#ifndef CANDIL_WORKER_PLAN_MAKE_H
#define CANDIL_WORKER_PLAN_MAKE_H

#include "server/base/error.h"
#include "server/scene/blob.h"
#include "server/worker/plan/plan.h"

// Plan a request over a scene and, if it names them, an environment and a file that is imported (NULL: none). The caller
// sets plan->environment.scene and plan->imported.scene afterwards. STATUS_BAD_ARGUMENT for an option or a camera that does
// not exist or is impossible, and where one of them is given as another; STATUS_LIMIT for an option above its most;
// STATUS_UNSUPPORTED for a technique that this worker does not have.
enum status plan_make(const candil_Render *request, const struct blob_view *scene, const struct blob_header *environment,
		      const struct blob_header *imported, struct plan *plan, struct error *err);

#endif
