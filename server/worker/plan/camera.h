// A plan's camera: one of the scene's or the request's own numbers, seen through the request's lens. Host only, any thread.
#ifndef CANDIL_WORKER_PLAN_CAMERA_H
#define CANDIL_WORKER_PLAN_CAMERA_H

#include "server/base/error.h"
#include "server/scene/blob.h"
#include "server/worker/plan/plan.h"

// Fill in plan->camera from a request that has passed the front's check. plan->width and height are set before.
// STATUS_BAD_ARGUMENT for a camera that the scene does not have, or that has no direction or field of view.
enum status plan_camera(const candil_Render *request, const struct blob_view *scene, struct plan *plan, struct error *err);

#endif
