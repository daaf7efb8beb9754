// Casters: the polished surfaces by way of which a lamp's light makes caustics. Equal input gives equal bits. One thread.
#ifndef CANDIL_SCENE_CASTERS_H
#define CANDIL_SCENE_CASTERS_H

#include "server/scene/blob.h"

// The share of light that a surface of this material mirrors or lets through without spreading it, 0…1: what a perfect
// mirror reflects at normal incidence, or what meets smooth glass. 0 for all that spreads light and for what is unlit. A
// texture's roughness is taken for the factor's, which it can only lower.
double casters_strength(const struct material *material);

// How many triangles of the scene cast.
uint32_t casters_count(const struct blob_view *scene);

// Put them into an alias table, chosen by area · strength. *rows (to be freed; NULL without any) holds as many as *count;
// density[m], an element a material, becomes the density over area with which a point of that material is chosen, 1/m².
// Triangles whose weight is no normal number are left out. STATUS_MEMORY.
enum status casters_make_table(const struct blob_view *scene, struct emitter **rows, uint32_t *count, float *density,
			       struct error *err);

#endif
