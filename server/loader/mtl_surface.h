// From MTL's Phong-like statements to the renderer's surface. One thread.
#ifndef CANDIL_LOADER_MTL_SURFACE_H
#define CANDIL_LOADER_MTL_SURFACE_H

#include "server/loader/import.h"
#include "server/loader/mtl_notes.h"

// Perceptual roughness of a Blinn-Phong exponent. The microfacets' α = sqrt(2 / (Ns + 2)) is Walter et al. 2007, the text
// below their equation 30 solved for the width; roughness is its root. Ns 0: 1; not finite or negative: as 0.
float mtl_roughness(double exponent);

// Set what a material's statements come to, after the albedo was set from Kd. False if a value had to be clamped.
//
// clang-format off
// | illum | meaning in MTL | here |
// | --- | --- | --- |
// | none | | as 2 if both Ks and Ns are above zero, else as 1 |
// | 0, 1 | colour; and diffuse shading | diffuse, Kd |
// | 2 | and highlights | and microfacets that reflect Ks at normal incidence and its largest component at grazing, as wide as Ns says |
// | 3, 8 | and reflection, traced or not | as 2; without Ns a perfect mirror |
// | 5 | the same by Fresnel | as 3, and all is reflected at grazing |
// | 4, 6, 7, 9 | and what is behind, straight or refracted | solid glass, where a Tf above zero, or without Tf a Ni or a d below 1, says that light comes through; else as 2 |
// | 10 | shadows on what is not seen | as 2, and told as ignored |
// clang-format on
//
// Glass has the index Ni (1.5 without), reflects by Fresnel, lets Tf through (all without; it counts once for both faces of
// a body), has the roughness Pr (0 without) and leaves Kd and Ks out. Other surfaces are there with the probability d, else
// 1 − Tr.
//
// Physically based exporters' statements go before illum, but for glass: with Pr or Pm the surface is glTF's, a metal of
// colour Kd by Pm (0 without), of roughness Pr (Ns's without, else 1), and what is no metal reflects as the index Ni does
// (1.5 without). Pc and Pcr are a clear coat, how much of it there is and its roughness. Pdr, our own, is the roughness of
// the diffuse part (Oren and Nayar). All are 0 to 1. Pp, our own, is a glass body's priority among those that it overlaps.
bool mtl_set_surface(struct import *import, const struct mtl_note *note, struct material *material);

// Whether texels are a normal map rather than heights: their mean points out of the surface, (0.5, 0.5, 1).
bool mtl_is_normal_map(const uint32_t *texels, uint32_t width, uint32_t height);

// A normal map out of a height map, by central differences, repeating at its edges. White stands one texel's width above
// black: how steep that is depends on the picture's size, and MTL has no better measure. The texels are malloc'ed.
enum status mtl_normals_of_heights(const uint32_t *texels, uint32_t width, uint32_t height, uint32_t **out,
				   struct error *err);

#endif
