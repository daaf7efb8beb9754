// The environment map, as the end of rays that leave the scene and as a light.
//
// Radiance is interpolated bilinearly between the middles of the texels, across the seam too. Next-event estimation chooses
// a texel from an alias table, then a direction in it, uniformly by solid angle. Both ways of sampling are weighted by the
// density of the texel that a look-up of the direction finds. So their weights sum to 1 for every direction, even where
// rounding assigns it to the neighbouring texel.
#ifndef PATH_SKY_GLSL
#define PATH_SKY_GLSL

#include "common/light.glsl"
#include "common/sky_place.glsl"
#include "shared/pt.h"

layout(constant_id = SPEC_SKY) const bool SKY = false;

layout(std430, set = 0, binding = BIND_ENVIRONMENT) readonly buffer EnvironmentTexels {
	vec4 sky_texels[];   // struct environment_texel
};
layout(std430, set = 0, binding = BIND_ENVIRONMENT_ROWS) readonly buffer EnvironmentRows {
	environment_row sky_rows[];
};

struct sky_view {
	vec3 radiance;
	float pdf;   // density of the direction by the table, 1/sr
};

sky_view sky_at(vec3 w)
{
	vec2 place = sky_place(w, job.sky_turn) * vec2(job.sky_width, job.sky_height);
	vec2 from = floor(place - 0.5);
	vec2 part = place - 0.5 - from;
	uint last = job.sky_height - 1u;
	uint x0 = from.x < 0.0 ? job.sky_width - 1u : min(uint(from.x), job.sky_width - 1u);
	uint x1 = x0 + 1u < job.sky_width ? x0 + 1u : 0u;
	uint y0 = min(uint(max(from.y, 0.0)), last) * job.sky_width;
	uint y1 = min(uint(from.y + 1.0), last) * job.sky_width;
	vec4 a = sky_texels[y0 + x0], b = sky_texels[y0 + x1], c = sky_texels[y1 + x0], d = sky_texels[y1 + x1];
	vec4 above = part.x < 0.5 ? a : b, below = part.x < 0.5 ? c : d;
	vec3 radiance = mix(mix(a.rgb, b.rgb, part.x), mix(c.rgb, d.rgb, part.x), part.y);
	return sky_view(radiance * job.sky_scale, part.y < 0.5 ? above.w : below.w);
}

// Chooses a texel. The row takes 39 random bits, so that even among many texels none is chosen more often than its
// neighbour; the table's `keep` takes 24 other bits.
uint sky_pick(uvec2 pick)
{
	uint count = job.sky_width * job.sky_height;
	uint row, low, carry;
	umulExtended(pick.x, count, row, low);
	uaddCarry(low, ((pick.y & 127u) * count) >> 7, carry);
	row += carry;
	environment_row e = sky_rows[row];
	return float(pick.y >> 8) * UNIT_24 < e.keep ? row : e.alias;
}

// Samples a direction in a texel. Measured from the nearer pole, the squared sine of half the polar angle is uniform, and
// precise.
vec3 sky_direction(uint texel, vec2 u)
{
	uint column = texel % job.sky_width, row = texel / job.sky_width;
	bool below = 2u * row >= job.sky_height;
	float line = float(below ? job.sky_height - 1u - row : row);
	vec2 edge = sin(vec2(line, line + 1.0) * (0.5 * PI / float(job.sky_height)));
	edge *= edge;
	float s = mix(edge.x, edge.y, u.y);
	float across = 2.0 * sqrt(max(s * (1.0 - s), 0.0));
	float longitude = ((float(column) + u.x) / float(job.sky_width) - 0.5 - job.sky_turn) * (2.0 * PI);
	float height = 1.0 - 2.0 * s;
	return vec3(across * sin(longitude), below ? -height : height, -across * cos(longitude));
}

// 1 / density of the directions of light paths that start at the environment map; a very large number if there are none.
float path_inverse(sky_view v)
{
	return 1.0 / max(v.pdf * job.sky_paths, 1e-30);
}

// Samples the environment map as a light. False if this sample brings no light.
bool choose_sky(uvec2 pick, vec2 u, out light_choice c)
{
	uint texel = sky_pick(pick);
	vec3 w = sky_direction(texel, u);
	float pdf = sky_texels[texel].w * job.sky_share;
	sky_view v = sky_at(w);
	float inverse = 1.0 / max(v.pdf * job.sky_share, 1e-30);
	c = light_choice(w, v.radiance, 1.0 / max(pdf, 1e-37), inverse, w, INFINITY, path_inverse(v), 0.0);
	return LAMPS_BY != LAMPS_BY_CHANCE && pdf > 0.0;
}

// Weighted radiance of a ray that left the scene. The weight is 1 for the camera's own ray, which no other technique
// samples.
vec3 sky_met(vec3 w, uint event, float pdf_bsdf)
{
	sky_view v = sky_at(w);
	if (event == 0u || LAMPS_BY == LAMPS_BY_CHANCE)
		return v.radiance;
	if (LAMPS_BY == LAMPS_BY_POINTS)
		return pdf_bsdf >= PDF_MIRROR ? v.radiance : vec3(0.0);
	return v.radiance * power_weight(min(v.pdf * job.sky_share / max(pdf_bsdf, 1e-37), 1e18));
}

// Whether next-event estimation samples the environment map.
bool sky_chosen(float table)
{
	return SKY && ((!EFFECT_EMITTERS && !EFFECT_LIGHTS) || table >= job.emitter_share + job.light_share);
}

#endif
