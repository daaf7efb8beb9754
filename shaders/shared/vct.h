// Voxel cone tracing: the directional pyramid, parameters and bindings. Used by C and GLSL.
//
// The pyramid. A cell has six values, one for each direction along an axis in which a cone looks (+x, −x, +y, −y, +z, −z).
// A value is the coverage, the share of the cell's face that surfaces hide when seen that way, and coverage × the radiance
// that they send back. The cells of the finest level are two voxels wide; those of each next level are twice as large. The
// six lie side by side along x in one texture.
#ifndef CANDIL_SHARED_VCT_H
#define CANDIL_SHARED_VCT_H

#include "shared/layout.h"

#define VCT_CONES_MAX 32
#define VCT_LEVELS_MAX 9
// Cones of each side of an entry in the bounce from surface to surface. An entry traces a quarter of them, chosen by the
// place of its voxel, so that the four entries that a wall has in a cell of the pyramid together trace all.
#define VCT_GATHER_CONES 16
#define VCT_GATHER_GROUPS 4

// How a cone is marched. An option's value goes into it as it is (vct_options.c), and from there to the shaders: 4-byte
// scalars, a multiple of 16 bytes in all.
struct vct_marching {
	float start; // distance of the first sample from the surface, in cells of the finest level
	float step; // distance between samples, as a share of the footprint's side; as an option of the cone's breadth
	float dither; // shift of the first sample from pixel to pixel, as a share of a step; 0: none
	float reach; // longest distance along a cone, metres; as an option 0: no end
	float ambient; // ambient radiance, dimmed where surfaces are near, W/(m² sr)
	float falloff; // 1/m: how fast that dimming falls off with distance
	float shadow_tangent; // tangent of the half aperture of shadow cones
	float unused;
};
LAYOUT_ASSERT(vct_marching, 32)
#ifndef GL_core_profile
typedef struct vct_marching vct_marching; // GLSL knows it without `struct`
#endif

// A std140 uniform block: vectors of four.
struct vct_params {
	float low[3]; // low corner of the grid, metres relative to the blob's origin
	float cell; // side of a cell of the finest level, metres
	uint sides[3]; // number of cells of the finest level along each axis
	uint top; // coarsest level that cones read
	float background[3]; // radiance where no surface is hit, W/(m² sr)
	float scale; // pyramid value = radiance × scale, to stay within the range of half floats
	vct_marching marching;
	uint cones; // number of diffuse cones
	uint emission; // 1: the pyramid contains the emission of surfaces
	float sky_turn; // environment map, as in struct scene_params
	float sky_scale;
	uint rays; // of each side of an entry, in the bounce from surface to surface by rays
	uint unused[3];
	float cone[VCT_CONES_MAX][4]; // direction in a frame whose z is the normal; weight: share of the cosine's integral
	float tangent[VCT_CONES_MAX][4]; // x: tangent of the half aperture
	float gather[VCT_GATHER_CONES][4]; // direction; tangent of the half aperture. All have the same weight
};
LAYOUT_ASSERT(vct_params, 112 + 32 * VCT_CONES_MAX + 16 * VCT_GATHER_CONES)
#define UNIFORM_VCT_PARAMS 1 // uniform block binding

// Storage blocks of floats, four for each side of an entry, the front (counter-clockwise) first: irradiance, W/m², and the
// share of the lights' irradiance that is not shadowed.
#define VCT_SIDE_FLOATS 4
#define VCT_ENTRY_FLOATS 8
#define BIND_VCT_DIRECT \
	26 // from the lights; then two uints: bits of the largest value, number of walks that the driver cut short
#define BIND_VCT_TOTAL 27 // from the lights, other surfaces and the background

// Uints: the number of cells of the finest level that have entries, then their numbers, with room for as many as there are
// entries. Then two areas, in units of side² / VCT_AREA_UNITS: of surfaces that bound thin walls, and of all surfaces.
#define BIND_VCT_CELLS 28
#define VCT_AREA_UNITS 16
#define VCT_AREA_MOST 8 // side²; limit of an entry's area: 2^25 such entries fit the sum
// A wall with fewer voxels than this is thin: light is known to leak through it (tests/bench/RESULTS.md).
#define VCT_THIN_ALIGNED 2 // for a wall at right angles to an axis of the grid
#define VCT_THIN_OBLIQUE 5 // for any other wall

#define VCT_PYRAMID_UNIT 4 // texture
#define VCT_SHARES_UNIT 7 // texture: as the pyramid's finest level, with unshadowed shares in place of radiance
#define VCT_PYRAMID_IMAGE 2 // image: the level being built
// Indirect light at half resolution (every second pixel of every second row): textures, and the images that they are
// written as.
#define VCT_IRRADIANCE_UNIT 5
#define VCT_FACETS_UNIT 6
#define VCT_IRRADIANCE_IMAGE 3
#define VCT_FACETS_IMAGE 4
// With rays: what they find where they land, as texel buffers: the voxels' own blocks and BIND_VCT_TOTAL, or a copy of it, a
// side's four floats a texel. Of an environment's picture also the table of its rows.
#define VCT_WORDS_UNIT 1 // uint, two a word of the grid
#define VCT_ALBEDO_UNIT 2
#define VCT_SENT_UNIT 3
#define VCT_EMISSION_UNIT 8
#define VCT_PLACE_UNIT 11
#define VCT_SKY_ROWS_UNIT 12 // uint, two a row
#define VCT_NEARNESS_UNIT \
	7 // texture, where no shares are read, and the image that it is written as: how near other surfaces are
#define VCT_NEARNESS_IMAGE 5
// Rays of a pixel are shared: in a block of so many by so many pixels that trace, each has its own part of one set.
#define VCT_SHARE_SIDE 4

#define VCT_GROUP 64 // invocations
#define VCT_RANGE 8 // uniform location, uvec2: first item of the dispatch, number of items
#define VCT_LEVEL 9 // uniform location, uint: the level being built
#define VCT_PIXEL_RAYS 10 // uniform location, uvec3: a pixel's first ray of this pass, the first that is not, and all

#endif
