// What every technique's passes know of a job, and what they count. Shared by C and GLSL.
#ifndef CANDIL_SHARED_SCENE_PARAMS_H
#define CANDIL_SHARED_SCENE_PARAMS_H

#include "shared/layout.h"

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
// Behind them in the buffer: a bit for each pixel of each tile that is set once a sample of it meets a surface.
#define MET_WORDS 2 // of a tile
#define CLAMP_UNITS 256

// What light paths contributed to a pixel: integers in units of scene_params.film_unit, so that the sum does not depend on
// the order.
struct film_pixel {
	uint parts[12]; // half A R G B, half B R G B; 64 bits each, low word first
};
LAYOUT_ASSERT(film_pixel, 48)
#define FILM_FULL 0x80000000u // a high word of this or more is an overflow: the sum may soon wrap round

#endif
