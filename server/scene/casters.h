// Casters: the polished surfaces by way of which a lamp's light makes caustics. Equal input gives equal bits. One thread.
#ifndef CANDIL_SCENE_CASTERS_H
#define CANDIL_SCENE_CASTERS_H

#include "server/scene/blob.h"

// Lobes of microfacets that are wider (α, the square of the perceptual roughness; of glass times |ior − 1|), or that reflect
// or let through less than that, are none of theirs: chance does as well. Measured: tests/bench/RESULTS.md.
#define CASTERS_ALPHA_MOST 0.25
#define CASTERS_ROUGH_LEAST 0.25

// The share of light that a surface of this material mirrors or lets through nearly unspread, 0…1: what a metal, a
// dielectric or a clear coat reflects at normal incidence, or what meets glass. 0 for all that spreads light and for what is
// unlit. With a texture of roughness and metal, the mean over some of its texels.
double casters_strength(const struct blob_view *scene, const struct material *material);

// How many triangles of the scene cast; 0 also for want of memory.
uint32_t casters_count(const struct blob_view *scene);

// Put them into an alias table, chosen by area · strength. *rows (to be freed; NULL without any) holds as many as *count;
// density[m], an element a material, becomes the density over area with which a point of that material is chosen, 1/m².
// Triangles whose weight is no normal number are left out. STATUS_MEMORY.
enum status casters_make_table(const struct blob_view *scene, struct emitter **rows, uint32_t *count, float *density,
			       struct error *err);

#endif
