// Binding numbers of set 0 and the parameters of the path tracer's passes, for C and GLSL.
#ifndef CANDIL_SHARED_BINDINGS_H
#define CANDIL_SHARED_BINDINGS_H

#include "shared/layout.h"

// The resident scene. Every pass that traces binds these.
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
#define BIND_GGX_TABLE 13 // directional albedos of the microfacet lobe: common/ggx.glsl
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
#define BIND_PATHS 17 // path: struct path_state, one an invocation, for paths longer than a dispatch
#define BIND_ERRORS 17 // error: a float a tile
#define BIND_AOV 16 // aov: 8 words a pixel: depth, normal, albedo, id
#define BIND_RAYS 15 // cast: struct cast_ray in; struct cast_hit out at BIND_HITS
#define BIND_HITS 16
// Whatever traces: the words of BIND_NODES and BIND_LEAF_TRIANGLES again, as texel buffers, four a texel.
#define BIND_NODE_TEXELS 18
#define BIND_LEAF_TEXELS 19
#define BIND_TRACE_COUNT 20
// Path alone: the picture of the surroundings, struct environment_texel and struct environment_row.
#define BIND_ENVIRONMENT 20
#define BIND_ENVIRONMENT_ROWS 21
#define BIND_CASTER_DENSITY 22 // a float a material: of points that BIND_CASTERS chooses on it, 1/m²
// Light paths have the same, and
#define BIND_FILM 16 // struct film_pixel
#define BIND_CASTERS 23 // struct emitter: polished triangles in an alias table
// And the tree over the lamps, where there is one: struct light_node as texels, and a uint an emitter, its trail.
#define BIND_LIGHT_NODES 24
#define BIND_LIGHT_TRAILS 25
#define BIND_PATH_COUNT 26
#define BIND_LIGHT_COUNT 26
#define BIND_ERROR_FILM 18 // error: BIND_FILM's
#define BIND_ERROR_COUNT 19
// No pass has more bindings than these, of which so many are texel buffers.
#define BIND_MOST 26
#define BIND_TEXELS_MOST 3

// Specialization constants. 0 … 31 are the effects', by their number (effects.glsl, made of protocol/names.h); from
// SPEC_EFFECTS on how a pass is run.
#define SPEC_EFFECTS 32
#define SPEC_RESUMED 32
#define SPEC_PACKET 33 // walk the tree by subgroups
#define SPEC_WIDTH 34 // lanes of a subgroup
#define SPEC_CAMERA 35 // CAMERA_…
#define SPEC_FILTER 36 // FILTER_…
#define SPEC_SAMPLER 37 // SAMPLER_…
#define SPEC_UNIFORM 38 // diffuse directions are uniform over the hemisphere, else as the cosine
#define SPEC_LAMPS_BY 39 // LAMPS_BY_…
#define SPEC_ROULETTE 40 // dim paths end by chance
#define SPEC_CLAMP 41 // no sample is brighter than the job's clamp
#define SPEC_SKY 42 // what is around the scene is a picture, and a light
#define SPEC_DISCS 43 // some directional light shines from a disc
#define SPEC_LIGHT_TREE 44 // lamps are chosen by the tree over them, else by their power alone
#define SPEC_PRIORITIES 45 // some clear body has a priority above 0
#define SPEC_END 46

// How the light of emissive surfaces is found: by points chosen on them and by directions that meet them, weighted; by the
// first alone; by the second alone.
#define LAMPS_BY_BOTH 0
#define LAMPS_BY_POINTS 1
#define LAMPS_BY_CHANCE 2

// Where samples come from: Sobol' points of the pixel's own, numbers that know nothing of each other, or Sobol' points
// shared out over neighbouring pixels.
#define SAMPLER_SOBOL 0
#define SAMPLER_INDEPENDENT 1
#define SAMPLER_BLUE 2

#define CAMERA_PINHOLE 0
#define CAMERA_LENS 1
#define CAMERA_PANORAMA 2
#define FILTER_BOX 0
#define FILTER_GAUSSIAN 1
#define FILTER_BLACKMAN_HARRIS 2

// The table at BIND_GGX_TABLE: for each of GGX_ROUGHNESSES perceptual roughnesses r, GGX_COSINES cosines μ, two floats, √r
// and √μ evenly spaced from 0 to 1; then two more a roughness: their averages over the hemisphere. Behind them the rough
// dielectric's: for each of GLASS_RATIOS indices of refraction η relative to the viewer's side, (η − 1) / (η + 1) evenly
// spaced from −1/2 to 1/2, but the last, GLASS_ROUGHNESSES by GLASS_COSINES pairs of floats: the share of light that single
// scattering keeps there and at the next η, √r and √μ spaced as above. And as many pairs again: the share of directions that
// are sampled on the side that they are meant for.
#define GGX_COSINES 64
#define GGX_ROUGHNESSES 64
#define GGX_TABLE_PAIRS (GGX_ROUGHNESSES * (GGX_COSINES + 1)) // before the dielectric's
#define GLASS_RATIOS 33
#define GLASS_ROUGHNESSES 24
#define GLASS_COSINES 24
#define GLASS_TABLE_PAIRS ((GLASS_RATIOS - 1) * GLASS_ROUGHNESSES * GLASS_COSINES)

#define ACCUMULATOR_FLOATS 12
#define AOV_WORDS 8
#define TILE_SIDE 8 // pixels; one workgroup
#define TILE_PIXELS 64
#define TILES_PER_LIGHT_TILE 4 // a light path for so many pixels' samples

// Everything about a job that stays the same from dispatch to dispatch.
struct scene_params {
	uint width;
	uint height;
	uint tiles_x; // tiles in a row of the image
	uint depth; // scattering events at most
	uint seed[2];
	uint emitter_count;
	uint light_count;
	float eye[3]; // metres, relative to the blob's origin
	float emitter_share; // probability that next-event estimation goes to the emissive triangles
	float right[3]; // half the image plane's width at distance 1
	float emitter_power_inv; // 1 / W: area pdf of an emissive triangle = power_density × this
	float up[3]; // half its height
	float orthographic; // 1: right and up are metres, rays are parallel
	float forward[3]; // unit
	uint has_uv1; // the scene has a second set of coordinates
	float background[3]; // W/(m² sr)
	uint has_colors; // and vertex colours
	float lens_right[3]; // a lens's radius, along the image's width
	float focus; // metres along `forward` to what a lens shows sharp
	float lens_up[3]; // along its height
	float clamp; // of a sample's largest component, W/(m² sr)
	uint run_bits; // SAMPLER_BLUE: 1 << this many samples of a half are a pixel's
	uint sky_width; // texels of the picture around the scene
	uint sky_height;
	float sky_turn; // of it, counter-clockwise seen from above, in revolutions, 0 … 1
	float sky_scale; // W/(m² sr) of its unit
	float sky_share; // probability that next-event estimation goes to it
	float light_share; // and to the punctual lights
	uint caster_count; // triangles at BIND_CASTERS
	float reach; // metres: from any point of the scene it is not further to outside of its bounds
	float film_unit; // W/(m² sr): a film's whole numbers count it, times the light paths of a sample
	float sky_paths; // share of the light paths that begin at the picture around the scene
};
LAYOUT_ASSERT(scene_params, 188)

// Where a dispatch works.
struct path_push {
	uint first_tile;
	uint tile_count;
	uint first_row; // of the band whose sums or AOVs are bound; pixels count from there
	uint first_sample; // of each pixel; sample n is number n >> 1 of half n & 1
	uint sample_count; // > 0; this dispatch's and those that resume it
	uint resumes; // 0: start the paths; else go on with those kept in BIND_PATHS
	uint round_count; // scattering events of a lane at most in this dispatch
	uint band_rows; // of that band
	uint light_tiles; // a sample of the band is as many light paths as so many tiles have lanes
};

// Of what the error of a picture is told.
struct error_push {
	uint first_tile;
	uint first_row; // of the band, as in path_push
	uint more_tiles; // the image's first tiles, that have more samples than the others
	uint has_film;
	float count_a; // samples of a pixel in half A
	float count_b;
	float more_a; // and in those first tiles
	float more_b;
	float film_a; // W/(m² sr) that one of a film's whole numbers is, in half A
	float film_b;
};
LAYOUT_ASSERT(error_push, 40)

struct pass_counters {
	uint rays;
	uint non_finite; // samples with a NaN or an infinity, taken as zero
	uint cut; // loops that the driver ended before their condition did
	uint loop_rounds; // the most that an invocation went round in its loops
	uint clamped; // samples that were too bright
	uint removed[2]; // what they lost in luminance, low word first, in CLAMP_UNITS to scene_params.clamp
	uint rays_high; // of the deferred techniques: 2³² rays; the path tracer's host reads often enough
};
LAYOUT_ASSERT(pass_counters, 32)
#define CLAMP_UNITS 256

struct path_state {
	float origin[3];
	uint event; // scattering events so far; PATH_DONE: nothing left to do
	float direction[3];
	float pdf; // of the direction, solid angle
	float throughput[3];
	uint taken; // samples that are done
	float radiance[3];
	uint media[2]; // materials whose inside it is in, 16 bits each from below: number + 1, or 0
	float rivals; // pt/caustic.glsl; of a light path the bits of its walker's `backs`
	float aim;
	float facing[3]; // of the surface that it left, for the tree over the lamps
};
LAYOUT_ASSERT(path_state, 88)
#define PATH_DONE 0xFFFFFFFFu

// What light paths brought to a pixel: whole numbers of scene_params.film_unit's, so that their sum does not depend on the
// order.
struct film_pixel {
	uint parts[12]; // half A R G B, half B R G B; each 64 bits, low word first
};
LAYOUT_ASSERT(film_pixel, 48)
#define FILM_FULL 0x80000000u // a high word from here on is too much: the sum may wrap round

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
