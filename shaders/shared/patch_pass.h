// The passes over the patches of radiosity that shade: what patches are made of (radiosity/patch_surface.comp.glsl), and
// what lights do to them (radiosity/patch_light.comp.glsl). Shared by C and GLSL.
#ifndef CANDIL_SHARED_PATCH_PASS_H
#define CANDIL_SHARED_PATCH_PASS_H

#include "shared/bindings.h"
#include "shared/radiosity.h"

#define BIND_PATCH_TRIANGLES (BIND_RADIOSITY_OWN) // two triangles' ids for each face; the second NONE: it is a triangle
#define BIND_PATCH_LIGHT (BIND_RADIOSITY_OWN + 1) // light: three floats for each element, irradiance, W/m²
#define BIND_PATCH_SKY (BIND_RADIOSITY_OWN + 2) // light: struct environment_texel
#define BIND_PATCH_SKY_ROWS (BIND_RADIOSITY_OWN + 3) // light: struct environment_row

#define SPEC_PATCH_COUNT 34 // patches
#define SPEC_PATCH_SKY 35 // light: PATCH_SKY_…
#define SPEC_PATCH_DISCS 36 // light: some directional light is a disc
#define SPEC_PATCH_BOUNCES 37 // light: bounces at mirrors by which the sky is seen
#define SPEC_PATCH_LAMPS 38 // light: emissive surfaces are looked at, too
#define SPEC_PATCH_END 39

#define PATCH_LAMPS 0xFFFFFFFEu // patch_push.light: emissive surfaces

// How the environment's picture is sampled.
#define PATCH_SKY_NONE 0 // there is none
#define PATCH_SKY_COSINE 1
#define PATCH_SKY_BOTH 2 // also by its table

#define PATCH_COVER_RAYS 16u // that tell whether a part of a patch is inside of another body

#define PATCH_GROUP 64 // invocations of a workgroup, a patch each

// A metal whose microfacets have an α (the square of the perceptual roughness) of at most this is a mirror.
#define PATCH_MIRROR_ALPHA 0.0025

// Points of a patch at which its material is looked at: one where nothing varies, some where colours of vertices do; where
// textures do, so many for each texel of the largest, between two bounds. All are powers of two. A patch that is smaller
// than a texel needs few where texels are interpolated, and where they are not those of a number of texels.
#define PATCH_POINTS_COLOURED 256
#define PATCH_POINTS_TEXEL 64
#define PATCH_POINTS_TEXTURED 64
#define PATCH_TEXELS_NEAREST 8.0
#define PATCH_POINTS_MOST 2048

// What a dispatch does, for patches `first` to first + count - 1.
struct patch_push {
	uint first;
	uint count;
	uint light; // light: its number; NONE: the sky; PATCH_LAMPS
	uint point; // light: the first of the points in this dispatch; cover: the part
	uint points; // light: how many
	uint all; // light: of all dispatches
	uint back; // light, sky and lamps: which side, 0 or 1
};
LAYOUT_ASSERT(patch_push, 28)

#endif
