// Casters: the polished surfaces by way of which a lamp's light makes caustics. Equal input gives equal bits. One thread.
#ifndef CANDIL_SCENE_CASTERS_H
#define CANDIL_SCENE_CASTERS_H

#include "server/scene/blob.h"

// A microfacet lobe does not make a caster if it is wider than the first (α, the square of the perceptual roughness; for
// glass times |ior − 1|), or if it reflects or transmits less than the second: there BSDF sampling does as well. Measured:
// tests/bench/RESULTS.md.
#define CASTERS_ALPHA_MOST 0.25
#define CASTERS_ROUGH_LEAST 0.25

// The share of light, 0…1, that a surface of this material reflects or transmits with little spread: the reflectance of a
// metal, a dielectric or a clear coat at normal incidence, or the share that is glass. 0 for unlit materials and those that
// only spread light. With a texture of roughness and metalness, the mean over some of its texels.
double casters_strength(const struct blob_view *scene, const struct material *material);

// Whether triangles of a material, an index of the scene's, are casters.
bool casters_has(const struct blob_view *scene, uint32_t material);

// The number of triangles that are casters; 0 also if there is no memory.
uint32_t casters_count(const struct blob_view *scene);

// Put the casters into an alias table by area · strength. *rows, which the caller frees, has *count rows; it is NULL if
// there are none. density[m], an array of the caller's with an element for each material, becomes the density over area,
// 1/m², of chosen points on that material. Triangles whose weight is not a normal number are left out. STATUS_MEMORY.
enum status casters_make_table(const struct blob_view *scene, struct emitter **rows, uint32_t *count, float *density,
			       struct error *err);

#endif
