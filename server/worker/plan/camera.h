// Where a plan's rays come from: the camera of a request, one of the scene's or its own numbers, through its lens. Host
// only.
#ifndef CANDIL_WORKER_PLAN_CAMERA_H
#define CANDIL_WORKER_PLAN_CAMERA_H

#include "server/base/error.h"
#include "server/scene/blob.h"
#include "server/worker/plan/plan.h"

// Fill in plan->camera from a checked request; the plan's width and height are set. STATUS_BAD_ARGUMENT for a camera that
// the scene does not have, or that cannot be.
enum status plan_camera(const candil_Render *request, const struct blob_view *scene, struct plan *plan, struct error *err);

#endif
