// Direct lighting as passes of a deferred renderer (deferred.h) on OpenGL: point, spot and directional lights, emissive
// triangles, and what is seen without being lit, that is emission, background and unlit surfaces. The technique `direct` is
// these passes alone; other techniques add their own light to them. Device's thread only.
//
//   lighting_init, lighting_step until lighting_ready, the passes, lighting_finish
#ifndef CANDIL_WORKER_DIRECT_LIGHTING_H
#define CANDIL_WORKER_DIRECT_LIGHTING_H

#include "server/worker/technique/common/sky_map.h"
#include "server/worker/technique/deferred/deferred.h"
#include "server/worker/technique/direct/direct_options.h"
#include "server/worker/technique/direct/shadow_maps.h"

#define LIGHTING_PASSES_MAX 2u

// In pictures of fewer samples neighbouring pixels share their points on emissive triangles. With more samples each pixel
// has enough points of its own, and shadows keep their edges.
#define DIRECT_SOFT_BELOW 16u

// What a technique asks for, beside what is in the plan.
struct lighting_wish {
	uint32_t points; // on emissive triangles, for a sample of a pixel; > 0
	bool own; // each pixel has its own points whatever the samples: noise in the place of a pattern
	uint32_t rays; // by the cosine, of a sample of a pixel, that find emissive triangles in the technique's own passes,
		       // if lighting_rivals says so; 0: there are none
	bool shadows; // false: every light reaches all that faces it
	uint32_t map_side; // texels of a shadow map's side; 0: all shadows are by rays
	bool dome; // nothing else gives light, and the plan's background does, evenly
	bool lamps; // emissive triangles light other surfaces; false: the technique does that itself
	uint32_t rows; // of pixels that are worked on at once; 0: as many as the device binds
};

// The lighting of one job.
struct lighting {
	struct gl_device *device;
	struct shadow_maps *maps; // held; NULL: every shadow is by rays
	const struct sky_map *sky; // NULL: there is no environment
	uint64_t compile_us; // host time that compiling the maps' programs took, for deferred_add_setup
	struct gl_texture scale, arrived, expected, facets; // of a band; only where pixels share points on lamps
	struct deferred_pass passes[LIGHTING_PASSES_MAX];
	uint32_t pass_count;
};

// The wish of a technique with these settings. `maps`: shadows of lights come out of maps, as far as there are shadows.
struct lighting_wish lighting_wish_of(const struct direct_settings *settings, bool maps, bool lamps);

// How many points of a sample of a pixel share the light of emissive triangles with the wish's rays, by the power heuristic
// (Veach 1997, 9.2.4) and the density of a choice by power. 0: the points have all of it, and rays must not find any. That
// is where a closed form tells what few triangles send, where shadows are left out, and where surfaces are not Lambert's.
uint32_t lighting_rivals(const struct plan *plan, const struct resident_scene *scene, const struct lighting_wish *wish);

// Device memory of a job's lighting, in bytes, without its scene.
uint64_t lighting_bytes(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan,
			const struct lighting_wish *wish);

// Make the passes, their textures, and shadow maps if the wish asks for them. *lighting must not move while its passes are
// in use. On failure nothing is left: STATUS_MEMORY, STATUS_DEVICE, STATUS_INTERNAL.
enum status lighting_init(struct lighting *lighting, struct devices *devices, struct resident_scene *scene,
			  const struct plan *plan, const struct lighting_wish *wish, struct error *err);

// Free it and let go of its shadow maps. A zeroed one is fine.
void lighting_finish(struct lighting *lighting);

// Work for about budget_us on what must be done before the first pass, the shadow maps. Fails as shadow_maps_step.
enum status lighting_step(struct lighting *lighting, struct gl_timer *timer, uint32_t budget_us, struct error *err);

// Whether that is done.
bool lighting_ready(const struct lighting *lighting);

// Add the options of shaders/direct/lighting.glsl as macros, for any program that includes it.
void lighting_define(struct gl_defines *defines, const struct plan *plan, const struct resident_scene *scene,
		     const struct lighting_wish *wish);

#endif
