// Bindings, constants and structures of the path tracer's passes: path, light, error, aov. Shared by C and GLSL.
#ifndef CANDIL_SHARED_PT_H
#define CANDIL_SHARED_PT_H

#include "shared/bindings.h"

#define BIND_PATHS 17 // path: struct path_state for each invocation, for paths longer than a dispatch
#define BIND_ERRORS 17 // error: struct error_tile for each tile
// For the path pass alone: the environment map, as struct environment_texel and struct environment_row.
#define BIND_ENVIRONMENT 20
#define BIND_ENVIRONMENT_ROWS 21
#define BIND_CASTER_DENSITY 22 // a float for each material: density, 1/m², of the points that BIND_CASTERS chooses on it
// The light pass has the bindings of the path pass and these two:
#define BIND_FILM 16 // struct film_pixel
#define BIND_CASTERS 23 // struct emitter: polished triangles in an alias table
#define BIND_PATH_COUNT 28
#define BIND_LIGHT_COUNT 28
#define BIND_ERROR_FILM 18 // error: the film, as at BIND_FILM
#define BIND_ERROR_COUNT 19

// Specialization constants, from SPEC_PASS on.
#define SPEC_RESUMED 34
#define SPEC_CAMERA 35 // CAMERA_…
#define SPEC_FILTER 36 // FILTER_…
#define SPEC_SAMPLER 37 // SAMPLER_…
#define SPEC_UNIFORM 38 // sample diffuse directions uniformly over the hemisphere, not by the cosine
#define SPEC_LAMPS_BY 39 // LAMPS_BY_…
#define SPEC_ROULETTE 40 // Russian roulette
#define SPEC_CLAMP 41 // clamp samples to the job's limit
#define SPEC_SKY 42 // the background is an environment map, and a light
#define SPEC_DISCS 43 // some directional light is a disc
#define SPEC_LIGHT_TREE 44 // choose lamps by the light tree, not by their power alone
#define SPEC_PRIORITIES 45 // some clear body has a priority above 0
#define SPEC_EMITTER_CELLS 46 // choose places on textured emissive triangles by their cells
#define SPEC_END 47

// Where sample points come from: Sobol' points for each pixel, independent random numbers, or Sobol' points distributed
// over neighbouring pixels.
#define SAMPLER_SOBOL 0
#define SAMPLER_INDEPENDENT 1
#define SAMPLER_BLUE 2

#define CAMERA_PINHOLE 0
#define CAMERA_LENS 1
#define CAMERA_PANORAMA 2
#define FILTER_BOX 0
#define FILTER_GAUSSIAN 1
#define FILTER_BLACKMAN_HARRIS 2

#define TILES_PER_LIGHT_TILE 4 // one light path for so many pixels' samples

// The work of a dispatch.
struct path_push {
	uint first_tile;
	uint tile_count;
	uint first_row; // first row of the band whose sums or AOVs are bound; their pixels count from there
	uint first_sample; // first sample of each pixel; sample n is number n >> 1 of half n & 1
	uint sample_count; // > 0; samples of this dispatch and of those that resume it
	uint resumes; // 0: start paths; else resume those kept in BIND_PATHS
	uint round_count; // limit of a lane's scattering events in this dispatch
	uint band_rows; // rows of the band
	uint light_tiles; // a sample of the band has a light path for each lane of this many tiles
};

// Parameters of the error pass.
struct error_push {
	uint first_tile;
	uint first_row; // first row of the band, as in path_push
	uint more_tiles; // number of tiles, from the image's first on, that have more samples than the others
	uint has_film;
	uint rows; // of the band
	float count_a; // samples of a pixel in half A
	float count_b;
	float more_a; // the same in those first tiles
	float more_b;
	float film_a; // W/(m² sr) of one unit of the film, in half A
	float film_b;
};
LAYOUT_ASSERT(error_push, 44)

// What the error pass tells of a tile: sums over its pixels, as struct relmse_sums.
struct error_tile {
	float terms, noise;
	float below, above;
	float lucky, light;
};
LAYOUT_ASSERT(error_tile, 24)

struct path_state {
	float origin[3];
	uint event; // scattering events so far; PATH_DONE: nothing left to do
	float direction[3];
	float pdf; // density of the direction, 1/sr
	float throughput[3];
	uint taken; // samples completed; PATH_PLAIN
	float radiance[3];
	uint media[2]; // clear bodies that the path is in, 16 bits each, lowest first: material + 1, or 0
	float rivals; // see pt/caustic.glsl; of a light path: its walker's `backs`
	float aim;
	float facing[3]; // facing normal of the surface that the path left, for the light tree
};
LAYOUT_ASSERT(path_state, 88)
#define PATH_DONE 0xFFFFFFFFu
#define PATH_PLAIN 0x80000000u // bit of `taken`: so far the path has met only what shows images

#endif
