// The error of the picture so far: each tile's part of the estimated relMSE, from the two independent halves of its
// samples.
//
// With a and b the means of the halves, ((a − b) / 2)² is an unbiased estimate of the variance of (a + b) / 2. relMSE
// divides by r² + 0.01, where r is the unknown true value; likely() estimates it.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "common/tile.glsl"
#include "common/accumulate.glsl"
#include "shared/pt.h"
#include "shared/scene_params.h"

layout(local_size_x = TILE_PIXELS) in;

layout(push_constant) uniform Push {
	error_push push;
};
layout(std430, set = 0, binding = BIND_JOB) readonly buffer Job {
	scene_params job;
};
layout(std430, set = 0, binding = BIND_ERROR_FILM) readonly buffer Film {
	film_pixel film[];
};
layout(std430, set = 0, binding = BIND_ERRORS) writeonly buffer Errors {
	float errors[];
};

shared vec4 parts[TILE_PIXELS];

// Sum over a quarter of the tile: the 4 × 4 pixels that contain this lane's. Lanes come in blocks of 4 × 2, two blocks a
// row.
vec4 quarter_sum(vec4 x)
{
	uint lane = gl_LocalInvocationIndex;
	uint block = lane / 8u;
	uint upper = block % 2u + block / 4u * 4u;
	vec4 sum = vec4(0.0);
	parts[lane] = x;
	barrier();
	for (uint i = 0u; i < 8u; i++)
		sum += parts[upper * 8u + i] + parts[(upper + 2u) * 8u + i];
	barrier();
	return sum;
}

// Sum over the tile; the result is valid in lane 0.
float tile_sum(float x)
{
	uint lane = gl_LocalInvocationIndex;
	parts[lane].x = x;
	barrier();
	for (uint reach = TILE_PIXELS / 2u; reach > 0u; reach /= 2u) {
		if (lane < reach)
			parts[lane].x += parts[lane + reach].x;
		barrier();
	}
	return parts[lane].x;
}

vec3 half_sum(uint first)
{
	return vec3(sums[first].x + sums[first].y, sums[first + 1u].x + sums[first + 1u].y, sums[first + 2u].x + sums[first + 2u].y);
}

// The mean of what light paths contributed to a pixel, W/(m² sr); `unit` is the radiance of one unit of the film.
vec3 film_mean(uint pixel, uint first, float unit)
{
	vec3 sum;
	for (uint i = 0u; i < 3u; i++) {
		uint part = 2u * (first + i);
		sum[i] = float(film[pixel].parts[part + 1u]) * 4294967296.0 + float(film[pixel].parts[part]);
	}
	return sum * unit;
}

// An estimate of a pixel's true value r. It is the pixel's own mean where that is known to a quarter. Elsewhere, the mean
// would hide its own error: a pixel that is much too bright would count as hardly wrong (measured: 0.13 of the true relMSE
// for eight samples of a room with caustics). There the estimate is the mean of the block of 4 × 4 pixels around it, which
// depends little on that pixel and still belongs to the same surface. If the lesser of the halves is larger, as where the
// pixel is brighter than its surroundings, that is used instead.
vec3 likely(vec3 a, vec3 b, vec3 around)
{
	vec3 mean = 0.5 * (a + b);
	return mix(max(min(a, b), around), mean, lessThan(2.0 * abs(a - b), abs(mean)));
}

// d² / (r² + 0.01), for numbers whose squares may overflow.
vec3 relative_square(vec3 d, vec3 r)
{
	vec3 unit = max(max(abs(d), abs(r)), vec3(1.0));
	vec3 x = d / unit, y = r / unit;
	return x * x / (y * y + 0.01 / unit / unit);
}

void main()
{
	uint tile = push.first_tile + gl_WorkGroupID.x;
	uvec2 pixel = tile_pixel(tile, job.tiles_x);
	bool mine = pixel.x < job.width && pixel.y < job.height;
	bool more = tile < push.more_tiles;
	float count_a = more ? push.more_a : push.count_a;
	float count_b = more ? push.more_b : push.count_b;
	vec3 mean = vec3(0.0);
	vec3 a = vec3(0.0);
	vec3 b = vec3(0.0);
	if (mine) {
		uint at = (pixel.y - push.first_row) * job.width + pixel.x;
		sums_load(at);
		a = half_sum(0u);
		b = half_sum(3u);
		if (push.has_film != 0u) {
			a += film_mean(at, 0u, push.film_a) * count_a;
			b += film_mean(at, 3u, push.film_b) * count_b;
		}
		mean = (a + b) / (count_a + count_b);
		a /= count_a;
		b /= count_b;
	}
	vec4 around = quarter_sum(vec4(mean, mine ? 1.0 : 0.0));
	vec3 relative = relative_square(0.5 * (a - b), likely(a, b, around.xyz / max(around.w, 1.0)));
	float sum = tile_sum(relative.r + relative.g + relative.b);
	if (gl_LocalInvocationIndex == 0u)
		errors[tile] = sum;
}
