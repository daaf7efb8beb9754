// What all techniques share about a plan and a scene: the parameters of their shaders, the sections that they upload, and
// powers by which they choose between lights. Host only, any thread. Nothing here fails.
#ifndef CANDIL_WORKER_TECHNIQUE_SCENE_PARAMS_H
#define CANDIL_WORKER_TECHNIQUE_SCENE_PARAMS_H

#include "server/worker/plan/plan.h"
#include "server/worker/scenes/resident.h"
#include "shaders/shared/bindings.h"
#include "shaders/shared/scene_params.h"

// Bindings (bits 1 << BIND_…) of the scene that shading by this plan reads. A pass that traces rays adds TRACE_BINDINGS.
uint32_t scene_bindings_shade(const struct plan *plan);

// Fill in the parameters of common/scene.glsl's `job`. Those that only one technique has are zero, for it to fill in.
// `sky_is_lamp`: next-event estimation samples the environment, too.
void scene_params_fill(const struct plan *plan, const struct blob_view *scene, bool sky_is_lamp, struct scene_params *out);

// Add a printf-formatted sentence to what a client is told of its job. It is cut to fit; one too many is dropped.
void technique_note(candil_Accepted *accepted, const char *format, ...) __attribute__((format(printf, 2, 3)));

// The probability of choosing a kind of light of power `of`, W, beside others of power `others`: its share of the power, but
// at least 0.1 for each side that has any, because a sun's power says little about a room that it does not reach.
float scene_share(double of, double others);

// Power of the environment through the scene's bounding sphere, W: π r² times the environment's power per area.
double scene_sky_power(const struct plan *plan, const struct blob_view *scene);

// 1 / power, 1/W; 0 for a power that is 0, or so small that the inverse fits no float.
float scene_power_inverse(float power);

// Power of the emissive triangles, W; 0 where the plan does not simulate them.
double scene_emitter_power(const struct plan *plan, const struct blob_view *scene);

// Power of the point, spot and directional lights, W, as their alias table weighs them; 0 where the plan does not simulate
// them.
double scene_light_power(const struct plan *plan, const struct blob_view *scene);

// Whether some directional light shines from a disc rather than from one direction.
bool scene_has_discs(const struct resident_scene *scene);

// How many tiles of TILE_SIDE pixels cover so many pixels of an image's side.
static inline uint32_t tiles_over(uint32_t pixels)
{
	return (pixels + TILE_SIDE - 1) / TILE_SIDE;
}

#endif
