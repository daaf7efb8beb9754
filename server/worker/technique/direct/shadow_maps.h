// Shadow maps of a scene's point, spot and directional lights (shaders/shared/shadow.h), drawn in slices and kept with the
// scene as loaded: every job whose geometry and lights are the same has them, whatever its camera or its materials, unless
// alpha cuts holes. Those whose light the scene has more than LIMIT_MAP_LIGHTS of, and all emissive surfaces, have none.
// Device's thread only.
//
//   shadow_maps_acquire (shadow_maps_step)* shadow_maps_bind* shadow_maps_release
#ifndef CANDIL_WORKER_TECHNIQUE_SHADOW_MAPS_H
#define CANDIL_WORKER_TECHNIQUE_SHADOW_MAPS_H

#include "server/worker/gl/buffer.h"
#include "server/worker/gl/program.h"
#include "server/worker/gl/texture.h"
#include "server/worker/gl/timer.h"
#include "server/worker/plan/plan.h"
#include "server/worker/scenes/shelf.h"

// All that the maps depend on. Compared by bytes.
struct shadow_key {
	uint64_t geometry, lights; // of struct scene_keys
	uint64_t materials; // 0 where nothing is cut out by alpha
	uint32_t effects; // of the plan, those that tell what is cut out
	uint32_t side; // texels
};

struct shadow_maps {
	struct shelved shelved;
	struct gl_device *device;
	struct shadow_key key;
	uint32_t count; // maps: layers of the texture
	struct gl_texture depths;
	struct gl_buffer views, lights; // UNIFORM_SHADOW_MAPS, BIND_SHADOW_LIGHTS
	// While they are drawn.
	struct resident_scene *scene; // NULL: finished
	uint32_t bindings;
	struct gl_program *programs[2]; // held: for whole triangles; for those with holes, if there may be any
	struct gl_buffer job; // struct scene_params
	unsigned framebuffer;
	uint32_t layer, triangle; // next
	uint32_t last; // triangles of the last piece
	double triangle_us; // measured
};

// Whether a job of this plan, which asks for maps of `side` texels (0: none), looks into shadow maps.
bool shadow_maps_wanted(const struct plan *plan, const struct resident_scene *scene, uint32_t side);

// Whether every light has one then.
bool shadow_maps_for_all(const struct resident_scene *scene);

// The maps of a scene, new ones begun if they are not there. *compile_us grows by what compiling took. STATUS_MEMORY if they
// cannot fit.
enum status shadow_maps_acquire(struct resident_scene *scene, struct gl_device *device, const struct plan *plan,
				uint32_t side, uint64_t *compile_us, struct shadow_maps **maps, struct error *err);

// Work on them for about budget_us; at once back if they are finished. Device time goes to the stage "shadow-maps".
enum status shadow_maps_step(struct shadow_maps *maps, struct gl_timer *timer, uint32_t budget_us, struct error *err);

static inline bool shadow_maps_finished(const struct shadow_maps *maps)
{
	return !maps->scene;
}

// Bind what direct/shadow_map.glsl reads.
void shadow_maps_bind(const struct shadow_maps *maps);

// NULL is allowed. The latest two that are finished stay with the scene.
void shadow_maps_release(struct shadow_maps *maps);

// Device memory of a plan's maps, in bytes; 0 where it wants none.
uint64_t shadow_maps_bytes(const struct plan *plan, const struct resident_scene *scene, uint32_t side);

#endif
