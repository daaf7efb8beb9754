// Shadow maps of a scene's point, spot and directional lights (shaders/shared/shadow.h), drawn in slices and kept with the
// scene as loaded. All jobs with the same geometry and lights share them, whatever their cameras and, unless alpha cuts
// holes, their materials. Only the SHADOW_LIGHTS_MAX strongest lights have maps; emissive surfaces have none. Device's
// thread only.
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

// Everything that the maps depend on. Compared by bytes.
struct shadow_key {
	uint64_t geometry, lights; // of struct scene_keys
	uint64_t materials; // 0 where nothing is cut out by alpha
	uint32_t effects; // of the plan's, those that decide what is cut out
	uint32_t side; // texels
};

// The maps of one key. Their shelf owns them; jobs hold them.
struct shadow_maps {
	struct shelved shelved;
	struct gl_device *device;
	struct shadow_key key;
	uint32_t count; // maps: layers of the texture
	struct gl_texture depths;
	struct gl_buffer views, lights; // UNIFORM_SHADOW_MAPS, BIND_SHADOW_LIGHTS
	// Only while they are drawn.
	struct resident_scene *scene; // that is drawn; NULL: the maps are finished
	uint32_t bindings;
	struct gl_program *programs[2]; // held: [0] for whole triangles; [1] for those with holes, NULL if there can be none
	struct gl_buffer job; // struct scene_params
	unsigned framebuffer;
	uint32_t layer, triangle; // where drawing goes on
	uint32_t last; // triangles in the last piece
	double triangle_us; // measured time of one; 0: not yet
};

// Whether a job of this plan that asks for maps of `side` texels (0: none) uses shadow maps.
bool shadow_maps_wanted(const struct plan *plan, const struct resident_scene *scene, uint32_t side);

// Whether every light of the scene then has a map.
bool shadow_maps_for_all(const struct resident_scene *scene);

// Hold the maps of a scene, beginning new ones if they are not there. *compile_us grows by the host time that compiling
// took. Pair with shadow_maps_release. STATUS_MEMORY if they do not fit; STATUS_DEVICE, STATUS_INTERNAL.
enum status shadow_maps_acquire(struct resident_scene *scene, struct gl_device *device, const struct plan *plan,
				uint32_t side, uint64_t *compile_us, struct shadow_maps **maps, struct error *err);

// Draw for about budget_us, at least one piece; return at once if they are finished. Device time goes to the timer's stage
// "shadow-maps". Fails as gl_check does.
enum status shadow_maps_step(struct shadow_maps *maps, struct gl_timer *timer, uint32_t budget_us, struct error *err);

// Whether all maps are drawn.
static inline bool shadow_maps_finished(const struct shadow_maps *maps)
{
	return !maps->scene;
}

// Bind what direct/shadow_map.glsl reads. The maps must be finished.
void shadow_maps_bind(const struct shadow_maps *maps);

// Let go of the maps. The latest two sets that are finished stay with the scene. NULL is allowed.
void shadow_maps_release(struct shadow_maps *maps);

// Device memory of a plan's maps, in bytes; 0 where it wants none.
uint64_t shadow_maps_bytes(const struct plan *plan, const struct resident_scene *scene, uint32_t side);

#endif
