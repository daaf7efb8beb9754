// Binding numbers of set 0 and parameters of the path tracer's passes. Shared by C and GLSL.
#ifndef CANDIL_SHARED_BINDINGS_H
#define CANDIL_SHARED_BINDINGS_H

#include "shared/layout.h"

// The resident scene. Every pass that traces rays binds these.
#define BIND_NODES 0
#define BIND_LEAF_TRIANGLES 1
#define BIND_TRIANGLES 2
#define BIND_VERTICES 3
#define BIND_MATERIALS 4
#define BIND_TEXTURES 5
#define BIND_TEXELS 6
#define BIND_EMITTERS 7
#define BIND_LIGHTS 8
#define BIND_SRGB_TABLE 9 // 256 floats: sRGB byte to linear
#define BIND_UV1 10
#define BIND_COLORS 11
#define BIND_TANGENTS 12
#ifndef BIND_GGX_TABLE
#define BIND_GGX_TABLE 13 // directional albedos of the microfacet lobe, described below
#endif
#define BIND_SCENE_COUNT 14
// OpenGL's texture units of the first two, which are texel buffers there.
#define UNIT_NODES 14
#define UNIT_LEAF_TRIANGLES 15
// The job.
#define BIND_JOB 14 // struct scene_params
#define BIND_COUNTERS 15 // struct pass_counters
#ifndef BIND_ACCUMULATOR
#define BIND_ACCUMULATOR 16 // path: 12 floats a pixel: half A then half B, R G B each as (hi, lo)
#endif
#define BIND_PATHS 17 // path: struct path_state for each invocation, for paths longer than a dispatch
#define BIND_ERRORS 17 // error: a float for each tile
#define BIND_AOV 16 // aov: 8 words for each pixel: depth, normal, albedo, id
#define BIND_RAYS 15 // cast: struct cast_ray in; struct cast_hit out at BIND_HITS
#define BIND_HITS 16
// For passes that trace: the words of BIND_NODES and BIND_LEAF_TRIANGLES again, as texel buffers, four words a texel.
#define BIND_NODE_TEXELS 18
#define BIND_LEAF_TEXELS 19
#define BIND_TRACE_COUNT 20
// For the path pass alone: the environment map, as struct environment_texel and struct environment_row.
#define BIND_ENVIRONMENT 20
#define BIND_ENVIRONMENT_ROWS 21
#define BIND_CASTER_DENSITY 22 // a float for each material: density, 1/m², of the points that BIND_CASTERS chooses on it
// The light pass has the bindings of the path pass and these two:
#define BIND_FILM 16 // struct film_pixel
#define BIND_CASTERS 23 // struct emitter: polished triangles in an alias table
// For both, where there is a light tree: struct light_node as texels, and each emitter's trail, a uint.
#define BIND_LIGHT_NODES 24
#define BIND_LIGHT_TRAILS 25
#define BIND_PATH_COUNT 26
#define BIND_LIGHT_COUNT 26
#define BIND_ERROR_FILM 18 // error: the film, as at BIND_FILM
#define BIND_ERROR_COUNT 19
// No pass has more bindings than BIND_MOST, of which at most BIND_TEXELS_MOST are texel buffers.
#define BIND_MOST 26
#define BIND_TEXELS_MOST 3

// Specialization constants. 0 … 31 switch the effects, by their number (effects.glsl, generated from protocol/names.h).
// From SPEC_EFFECTS on they say how a pass runs.
#define SPEC_EFFECTS 32
#define SPEC_RESUMED 32
#define SPEC_PACKET 33 // subgroups walk the BVH as packets
#define SPEC_WIDTH 34 // lanes of a subgroup
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
#define SPEC_END 46

// How paths find the light of emissive surfaces: by points sampled on them and by BSDF sampling, weighted; by points alone;
// by BSDF sampling alone.
#define LAMPS_BY_BOTH 0
#define LAMPS_BY_POINTS 1
#define LAMPS_BY_CHANCE 2

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

// The table at BIND_GGX_TABLE. First the microfacets: for each of GGX_ROUGHNESSES perceptual roughnesses r and each of
// GGX_COSINES cosines μ, two floats (common/ggx.glsl), with √r and √μ evenly spaced from 0 to 1. Then, for each roughness,
// two floats: their mean over the hemisphere. Then the rough dielectric (common/glass.glsl): for each of GLASS_RATIOS
// relative indices of refraction η but the last, (η − 1) / (η + 1) evenly spaced from −1/2 to 1/2, GLASS_ROUGHNESSES by
// GLASS_COSINES pairs of floats, √r and √μ spaced as above: the share of light that single scattering keeps, at this η and
// at the next. Last, as many pairs again: the share of sampled directions that are on the intended side.
#define GGX_COSINES 64
#define GGX_ROUGHNESSES 64
#define GGX_TABLE_PAIRS (GGX_ROUGHNESSES * (GGX_COSINES + 1)) // before the dielectric's part
#define GLASS_RATIOS 33
#define GLASS_ROUGHNESSES 24
#define GLASS_COSINES 24
#define GLASS_TABLE_PAIRS ((GLASS_RATIOS - 1) * GLASS_ROUGHNESSES * GLASS_COSINES)

#define ACCUMULATOR_FLOATS 12
#define AOV_WORDS 8
#define TILE_SIDE 8 // pixels; a tile is one workgroup
#define TILE_PIXELS 64
#define TILES_PER_LIGHT_TILE 4 // one light path for so many pixels' samples

// All parameters of a job that are the same in every dispatch.
struct scene_params {
	uint width;
	uint height;
	uint tiles_x; // tiles in a row of the image
	uint depth; // scattering events at most
	uint seed[2];
	uint emitter_count;
	uint light_count;
	float eye[3]; // metres, relative to the blob's origin
	float emitter_share; // probability that next-event estimation samples an emissive triangle
	float right[3]; // half the width of the image plane at distance 1
	float emitter_power_inv; // 1/W: an emissive triangle's density over area is power_density × this
	float up[3]; // half the height of the image plane
	float orthographic; // 1: right and up are metres, rays are parallel
	float forward[3]; // unit
	uint has_uv1; // 1: the scene has a second set of texture coordinates
	float background[3]; // radiance, W/(m² sr)
	uint has_colors; // 1: the scene has vertex colours
	float lens_right[3]; // vector of the lens's radius, along the image's width
	float focus; // distance in focus along `forward`, metres
	float lens_up[3]; // vector of the lens's radius, along the image's height
	float clamp; // limit of a sample's largest component, W/(m² sr)
	uint run_bits; // SAMPLER_BLUE: a pixel has 1 << this many samples in a half
	uint sky_width; // size of the environment map, texels
	uint sky_height;
	float sky_turn; // rotation of the environment map, counter-clockwise seen from above, in revolutions, 0 … 1
	float sky_scale; // W/(m² sr) for a value of 1 in the environment map
	float sky_share; // probability that next-event estimation samples the environment map
	float light_share; // probability that it samples a punctual light
	uint caster_count; // triangles at BIND_CASTERS
	float reach; // metres; from any point of the scene, the outside of its bounds is not farther
	float film_unit; // W/(m² sr) of one unit of the film, times the light paths of a sample
	float sky_paths; // share of the light paths that start at the environment map
};
LAYOUT_ASSERT(scene_params, 188)

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
	float count_a; // samples of a pixel in half A
	float count_b;
	float more_a; // the same in those first tiles
	float more_b;
	float film_a; // W/(m² sr) of one unit of the film, in half A
	float film_b;
};
LAYOUT_ASSERT(error_push, 40)

struct pass_counters {
	uint rays;
	uint non_finite; // samples with a NaN or an infinity; they count as zero
	uint cut; // loops that the driver ended before their condition did
	uint loop_rounds; // largest number of loop rounds of an invocation
	uint clamped; // samples that were clamped
	uint removed[2]; // luminance that clamping removed, low word first, in units of scene_params.clamp / CLAMP_UNITS
	uint rays_high; // deferred techniques: high word of `rays`; the path tracer's host reads `rays` before it overflows
};
LAYOUT_ASSERT(pass_counters, 32)
#define CLAMP_UNITS 256

struct path_state {
	float origin[3];
	uint event; // scattering events so far; PATH_DONE: nothing left to do
	float direction[3];
	float pdf; // density of the direction, 1/sr
	float throughput[3];
	uint taken; // samples completed
	float radiance[3];
	uint media[2]; // clear bodies that the path is in, 16 bits each, lowest first: material + 1, or 0
	float rivals; // see pt/caustic.glsl; of a light path: the bits of its walker's `backs`
	float aim;
	float facing[3]; // facing normal of the surface that the path left, for the light tree
};
LAYOUT_ASSERT(path_state, 88)
#define PATH_DONE 0xFFFFFFFFu

// What light paths contributed to a pixel: integers in units of scene_params.film_unit, so that the sum does not depend on
// the order.
struct film_pixel {
	uint parts[12]; // half A R G B, half B R G B; 64 bits each, low word first
};
LAYOUT_ASSERT(film_pixel, 48)
#define FILM_FULL 0x80000000u // a high word of this or more is an overflow: the sum may soon wrap round

struct cast_ray {
	float origin[3];
	float t_max;
	float direction[3];
	uint reserved;
};
LAYOUT_ASSERT(cast_ray, 32)

struct cast_hit {
	float t;
	uint id; // triangle id; NONE: nothing hit. For any: 0 if something was hit
	float u;
	float v;
};
LAYOUT_ASSERT(cast_hit, 16)

#endif
