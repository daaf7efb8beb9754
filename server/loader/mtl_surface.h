// From MTL's Phong-like statements to the renderer's surface. One thread.
#ifndef CANDIL_LOADER_MTL_SURFACE_H
#define CANDIL_LOADER_MTL_SURFACE_H

#include "server/loader/import.h"
#include "server/loader/mtl_notes.h"

// Perceptual roughness of a Blinn-Phong exponent. The microfacets' α = sqrt(2 / (Ns + 2)) is Walter et al. 2007, the text
// below their equation 30 solved for the width; roughness is its root. Ns 0: 1; not finite or negative: as 0.
float mtl_roughness(double exponent);

// Set specular, specular_weight and roughness as illum, Ks and Ns say: none for illum 0 and 1, and where there is no illum
// unless both Ks and Ns are above zero; else Ks at normal incidence and its largest component at grazing, for illum 3, 5, 8
// and 10 as for 2. illum 4, 6, 7 and 9 with a Tf above zero, or without Tf but with Ni or d, are smooth and solid glass of
// the index Ni (1.5 without), which lets Tf through (all without) and leaves Kd and Ks out; after the albedo was set. Other
// surfaces are there with the probability d. False if a value had to be clamped.
bool mtl_set_surface(struct import *import, const struct mtl_note *note, struct material *material);

// Whether texels are a normal map rather than heights: their mean points out of the surface, (0.5, 0.5, 1).
bool mtl_is_normal_map(const uint32_t *texels, uint32_t width, uint32_t height);

// A normal map out of a height map, by central differences, repeating at its edges. White stands one texel's width above
// black: how steep that is depends on the picture's size, and MTL has no better measure. The texels are malloc'ed.
enum status mtl_normals_of_heights(const uint32_t *texels, uint32_t width, uint32_t height, uint32_t **out,
				   struct error *err);

#endif
