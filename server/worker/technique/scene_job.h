// What every technique tells its shaders about a plan and a scene, and what it needs of the scene on its device.
#ifndef CANDIL_WORKER_TECHNIQUE_SCENE_JOB_H
#define CANDIL_WORKER_TECHNIQUE_SCENE_JOB_H

#include "server/worker/plan.h"
#include "server/worker/resident.h"
#include "shaders/shared/bindings.h"

// Bindings (bits 1 << BIND_…) that shading by this plan reads; a pass that traces rays adds scene_bindings_trace.
uint32_t scene_bindings_shade(const struct plan *plan);
uint32_t scene_bindings_trace(void);

// The parameters in common/scene.glsl's `job`.
void scene_job_fill(const struct plan *plan, const struct blob_view *scene, struct pt_job *out);

// Whether a directional light has a width.
bool scene_has_discs(const struct resident_scene *scene);

#endif
