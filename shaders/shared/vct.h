// Voxel cone tracing, for C and GLSL: the directional pyramid, its parameters and bindings.
//
// The pyramid. Six values a cell, one for each way along an axis that light is looked for (+x, −x, +y, −y, +z, −z): the
// share of the cell's face that surfaces cover when looked at that way, and that share × the radiance that they send back.
// Its finest level has cells of two voxels; each next level's are twice as large. The six lie side by side along x in one
// texture.
#ifndef CANDIL_SHARED_VCT_H
#define CANDIL_SHARED_VCT_H

#include "shared/layout.h"

#define VCT_CONES_MAX 32
#define VCT_LEVELS_MAX 9
// Cones of an entry's side when light goes from surface to surface: a quarter each, by the place of its voxel, so that the
// four entries that a wall has in a cell of the pyramid have all together.
#define VCT_GATHER_CONES 16
#define VCT_GATHER_GROUPS 4

// A uniform block, std140: vectors of four.
struct vct_params {
	float low[3]; // the grid's low corner, metres relative to the blob's origin
	float cell; // side of a cell of the finest level, metres
	uint sides[3]; // cells of the finest level along each axis
	uint top; // the coarsest level that cones read
	float background[3]; // radiance, W/(m² sr), of what no surface hides
	float scale; // radiance in the pyramid = radiance × scale: keeps it within half floats
	float start; // cells of the finest level between a surface and the first sample
	float step; // of the footprint's side, from sample to sample
	float dither; // of a step, the first sample's shift from pixel to pixel; 0: none
	uint cones; // diffuse cones
	float reach; // metres at most along a cone
	uint emission; // 1: surfaces' emission is in the pyramid
	float ambient; // radiance that comes from everywhere, but where surfaces are near; W/(m² sr)
	float falloff; // 1/m: how soon they are no longer near
	float shadow_tangent; // of a shadow cone's half aperture
	float sky_turn; // of the picture around the scene, as in struct scene_params
	float sky_scale;
	float unused;
	float cone[VCT_CONES_MAX][4]; // direction in a frame whose z is the normal; its weight of the cosine's integral
	float tangent[VCT_CONES_MAX][4]; // x: of the half aperture
	float gather[VCT_GATHER_CONES][4]; // direction; tangent of the half aperture. All weigh the same
};
LAYOUT_ASSERT(vct_params, 96 + 32 * VCT_CONES_MAX + 16 * VCT_GATHER_CONES)
#define UNIFORM_VCT_PARAMS 1 // uniform block binding

// Storage blocks: floats, four a side of an entry, its front (counter-clockwise) first: irradiance, W/m², and the share of
// the lights' that no shadow takes away.
#define VCT_SIDE_FLOATS 4
#define VCT_ENTRY_FLOATS 8
#define BIND_VCT_DIRECT \
	26 // from the lights; two uints more at the end: bits of the largest of all, walks that the driver cut short
#define BIND_VCT_TOTAL 27 // and from other surfaces and the background

// Uints: how many cells of the finest level have entries, then which, with room for as many as there are entries; and behind
// that the area, in VCT_AREA_UNITS to side², of surfaces that bound thin walls, and of all surfaces.
#define BIND_VCT_CELLS 28
#define VCT_AREA_UNITS 16
#define VCT_AREA_MOST 8 // side², of an entry that is counted: 2^25 of them fit a sum
// A wall is thin, in voxels, where light is known to leak through: tests/bench/RESULTS.md.
#define VCT_THIN_ALIGNED 2 // at right angles to an axis of the grid…
#define VCT_THIN_OBLIQUE 5 // …or not

#define VCT_PYRAMID_UNIT 4 // texture
#define VCT_SHARES_UNIT 7 // texture: like the pyramid's finest level, with shares in the place of radiance
#define VCT_PYRAMID_IMAGE 2 // image: the level that is being made
// Indirect light of every second pixel of every second row: textures, and the images that they are made as.
#define VCT_IRRADIANCE_UNIT 5
#define VCT_FACETS_UNIT 6
#define VCT_IRRADIANCE_IMAGE 3
#define VCT_FACETS_IMAGE 4

#define VCT_GROUP 64 // invocations
#define VCT_RANGE 8 // uniform location, uvec2: first item of the dispatch, and how many
#define VCT_LEVEL 9 // uniform location, uint: the level being made

#endif
