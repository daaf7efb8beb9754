// What the camera sees and the light that comes straight from its sources: a deferred renderer's picture, on OpenGL. The
// baseline that everything with bounces is measured against.
#ifndef CANDIL_WORKER_TECHNIQUE_DIRECT_H
#define CANDIL_WORKER_TECHNIQUE_DIRECT_H

#include "server/worker/technique/deferred.h"

extern const struct technique technique_direct;

// The passes of this technique over a scene, for one that adds its own light to them. Returns how many, at most two.
uint32_t direct_passes(const struct plan *plan, const struct resident_scene *scene, struct deferred_pass passes[2]);

// Whether the plan lets emissive surfaces light others by the voxels alone, where cones find them: vct.emitters=cones, or
// auto where they are too many, or textured, to be aimed at.
bool direct_lamps_in_volume(const struct plan *plan, const struct resident_scene *scene);

// The options of shaders/direct/lighting.glsl as macros, for any program that includes it.
void direct_define(struct gl_defines *defines, const struct plan *plan, const struct resident_scene *scene);

#endif
