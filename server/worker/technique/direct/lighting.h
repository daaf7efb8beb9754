// The light that comes straight from its sources, and all that the camera sees besides it, as passes of a deferred renderer
// on OpenGL: emitted light, background, unlit surfaces, point, spot and directional lights, emissive triangles. The
// technique `direct` is these passes alone; others add their own light to them. Device's thread only.
//
//   lighting_init, lighting_step until lighting_ready, the passes, lighting_finish
#ifndef CANDIL_WORKER_DIRECT_LIGHTING_H
#define CANDIL_WORKER_DIRECT_LIGHTING_H

#include "server/worker/technique/common/sky_map.h"
#include "server/worker/technique/deferred/deferred.h"
#include "server/worker/technique/direct/shadow_maps.h"

#define LIGHTING_PASSES_MAX 2u

// Pictures of fewer samples share the lamps' points between neighbouring pixels; more samples have points enough of their
// own, and shadows keep their edges.
#define DIRECT_SOFT_BELOW 16u

// What a technique asks of it, beside what is in the plan.
struct lighting_wish {
	uint32_t points; // on emissive triangles, for a pixel's sample; > 0
	bool shadows; // false: every light reaches all that faces it
	uint32_t map_side; // texels of a shadow map's side; 0: all shadows by rays
	bool lamps; // emissive triangles light others; false: the technique does that by itself
	uint32_t rows; // of pixels that are worked on at once; 0: as many as the device binds
};

struct lighting {
	struct gl_device *device;
	struct shadow_maps *maps; // NULL: every shadow by rays
	const struct sky_map *sky; // NULL: what is around is no picture
	uint64_t compile_us; // of what draws them, for deferred_add_setup
	struct gl_texture scale, arrived, expected, facets; // of a band; only if lamps' points are shared, facets if any are
	struct deferred_pass passes[LIGHTING_PASSES_MAX];
	uint32_t pass_count;
};

// Device memory, in bytes, without its scene.
uint64_t lighting_bytes(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan,
			const struct lighting_wish *wish);

// It must not move while its passes are in use. On failure nothing is left.
enum status lighting_init(struct lighting *lighting, struct devices *devices, struct resident_scene *scene,
			  const struct plan *plan, const struct lighting_wish *wish, struct error *err);
void lighting_finish(struct lighting *lighting); // a zeroed one is fine

// What must be done before the first pass: the shadow maps. As struct technique's step, for about budget_us.
enum status lighting_step(struct lighting *lighting, struct gl_timer *timer, uint32_t budget_us, struct error *err);
bool lighting_ready(const struct lighting *lighting);

// The options of shaders/direct/lighting.glsl as macros, for any program that includes it.
void lighting_define(struct gl_defines *defines, const struct plan *plan, const struct resident_scene *scene,
		     const struct lighting_wish *wish);

#endif
