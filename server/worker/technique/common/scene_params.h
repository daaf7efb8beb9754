// What every technique tells its shaders about a plan and a scene, and what it needs of the scene on its device.
#ifndef CANDIL_WORKER_TECHNIQUE_SCENE_PARAMS_H
#define CANDIL_WORKER_TECHNIQUE_SCENE_PARAMS_H

#include "server/worker/plan/plan.h"
#include "server/worker/scenes/resident.h"
#include "shaders/shared/scene_params.h"

// Bindings (bits 1 << BIND_…) that shading by this plan reads; a pass that traces rays adds TRACE_BINDINGS.
uint32_t scene_bindings_shade(const struct plan *plan);

// The parameters in common/scene.glsl's `job`, but for what a technique fills in by itself.
// `sky_is_lamp`: next-event
// estimation goes to the picture around the scene, too.
void scene_params_fill(const struct plan *plan, const struct blob_view *scene, bool sky_is_lamp, struct scene_params *out);

// Add a sentence to what a client is told of its job; one too many is dropped.
void technique_note(candil_Accepted *accepted, const char *format, ...) __attribute__((format(printf, 2, 3)));

// How random choices between two kinds of light are divided: the share of the one with power `of`, W, beside the others',
// never less than a tenth to either that has any, for a sun's power says little about a room that it does not reach.
float scene_share(double of, double others);

// What of the picture around the scene meets the sphere about it, W.
double scene_sky_power(const struct plan *plan, const struct blob_view *scene);

// What the emissive triangles and the lights that the plan simulates send, W.
double scene_emitter_power(const struct plan *plan, const struct blob_view *scene);
double scene_light_power(const struct plan *plan, const struct blob_view *scene);

// Whether a directional light has a width.
bool scene_has_discs(const struct resident_scene *scene);

#endif
