// What the camera sees and the light that comes straight from its sources: a deferred renderer's picture, on OpenGL. The
// baseline that everything with bounces is measured against.
#ifndef CANDIL_WORKER_TECHNIQUE_DIRECT_H
#define CANDIL_WORKER_TECHNIQUE_DIRECT_H

#include "server/worker/technique/deferred.h"
#include "server/worker/technique/shadow_maps.h"
#include "server/worker/technique/sky_map.h"

#define DIRECT_PASSES_MAX 2u

// Pictures of fewer samples share the lamps' points between neighbouring pixels; more samples have points enough of their
// own, and shadows keep their edges.
#define DIRECT_SOFT_BELOW 16u

extern const struct technique technique_direct;

// The technique's passes, for others that add their own light to them: emitted light, background, unlit surfaces, and what
// comes straight from every light.
struct direct_lighting {
	struct gl_device *device;
	struct shadow_maps *maps; // NULL: every shadow by rays
	const struct sky_map *sky; // NULL: what is around is no picture
	uint64_t compile_us; // of what draws them, for deferred_add_setup
	struct gl_texture scale, arrived, expected, facets; // of a band; only if lamps' points are shared, facets if any are
	struct deferred_pass passes[DIRECT_PASSES_MAX];
	uint32_t pass_count;
};

// Device memory, in bytes.
uint64_t direct_lighting_bytes(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan);

// It must not move while its passes are in use. On failure nothing is left.
enum status direct_lighting_init(struct direct_lighting *lighting, struct devices *devices, struct resident_scene *scene,
				 const struct plan *plan, struct error *err);
void direct_lighting_finish(struct direct_lighting *lighting); // a zeroed one is fine

// What must be done before the first pass: the shadow maps. As struct technique's step, for about budget_us.
enum status direct_lighting_step(struct direct_lighting *lighting, struct gl_timer *timer, uint32_t budget_us,
				 struct error *err);
bool direct_lighting_ready(const struct direct_lighting *lighting);

// The side of shadow maps with which a plan's job would take no more than `budget` bytes, as the end of a sentence (see
// struct technique); nothing is written where there is none. `bytes`: of the technique.
void direct_advise_map(uint64_t (*bytes)(const struct devices *devices, const struct resident_scene *scene,
					 const struct plan *plan),
		       const struct devices *devices, const struct resident_scene *scene, const struct plan *plan,
		       uint64_t budget, char *advice);

// Whether the plan lets emissive surfaces light others by the voxels alone, where cones find them: vct.emitters=cones.
bool direct_lamps_in_volume(const struct plan *plan, const struct resident_scene *scene);

// The options of shaders/direct/lighting.glsl as macros, for any program that includes it.
void direct_define(struct gl_defines *defines, const struct plan *plan, const struct resident_scene *scene);

#endif
