// Translates MTL's Phong-like statements to the renderer's material. One thread.
#ifndef CANDIL_LOADER_MTL_SURFACE_H
#define CANDIL_LOADER_MTL_SURFACE_H

#include "server/loader/import.h"
#include "server/loader/mtl_notes.h"

// The perceptual roughness for a Blinn-Phong exponent. The microfacets' α = sqrt(2 / (Ns + 2)) is from Walter et al. 2007,
// the text below their equation 30 solved for the width; the roughness is its root. Ns 0 gives 1, as do negative values and
// those that are not finite.
float mtl_roughness(double exponent);

// Set the material's lobes from a note's statements; mtl_material sets the albedo and the emission first. Statements without
// effect are noted as ignored. False if a value had to be clamped.
//
// clang-format off
// | illum | meaning in MTL | here |
// | --- | --- | --- |
// | none | | as 2 if both Ks and Ns are above zero, else as 1 |
// | 0, 1 | colour; and diffuse shading | diffuse, Kd |
// | 2 | and highlights | and microfacets that reflect Ks at normal incidence and its largest component at grazing, as wide as Ns says |
// | 3, 8 | and reflection, traced or not | as 2; without Ns a perfect mirror |
// | 5 | the same by Fresnel | as 3, and all is reflected at grazing |
// | 4, 6, 7, 9 | and what is behind, straight or refracted | solid glass, where a Tf above zero, or without Tf a Ni or a d below 1, says that light comes through, but not where Ni 1 and a Tf of 1 or none would make it nothing; else as 2 |
// | 10 | shadows on what is not seen | as 2, and noted as ignored |
// clang-format on
//
// Glass has the index Ni (1.5 without), reflects by Fresnel's equations, transmits Tf (everything without; Tf counts once
// for both faces of a body), has the roughness Pr (0 without) and ignores Kd and Ks. Other surfaces are present with the
// probability d, or 1 − Tr without d.
//
// The statements of physically based exporters take precedence over illum, except for glass. With Pr or Pm the surface is
// glTF's: metallic by Pm (0 without) with the colour Kd, of roughness Pr (without it Ns's, else 1), its dielectric part of
// index Ni (1.5 without). Pc and Pcr are the weight and the roughness of a clear coat. Pdr, our own, is the roughness of the
// diffuse part (Oren and Nayar). All of these are 0 to 1. Pp, our own, is the priority of a glass body over those that it
// overlaps.
bool mtl_set_surface(struct import *import, const struct mtl_note *note, struct material *material);

// Whether a texture is a normal map rather than heights: the mean of a normal map points out of the surface, (0.5, 0.5, 1).
bool mtl_is_normal_map(const struct texture_info *texture, const uint32_t *texels);

// Make a normal map from a height map, by central differences; the map repeats at its edges. White is one texel's width
// higher than black. So the steepness depends on the size of the picture, but MTL has no better measure. *out becomes an
// array that the caller frees, as deep as the heights. STATUS_MEMORY.
enum status mtl_normals_of_heights(const struct texture_info *texture, const uint32_t *texels, uint32_t **out,
				   struct error *err);

#endif
