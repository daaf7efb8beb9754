// The environment map, as the end of rays that leave the scene and as a light.
//
// Radiance is interpolated bilinearly between the middles of the texels, across the seam too. Next-event estimation chooses
// a texel from an alias table, then a direction in it, uniformly by solid angle. Both ways of sampling are weighted by the
// density of the texel that a look-up of the direction finds. So their weights sum to 1 for every direction, even where
// rounding assigns it to the neighbouring texel.
#ifndef PATH_SKY_GLSL
#define PATH_SKY_GLSL

#include "common/light.glsl"
#include "shared/pt.h"

layout(constant_id = SPEC_SKY) const bool SKY = false;

layout(std430, set = 0, binding = BIND_ENVIRONMENT) readonly buffer EnvironmentTexels {
	vec4 sky_texels[];   // struct environment_texel
};
layout(std430, set = 0, binding = BIND_ENVIRONMENT_ROWS) readonly buffer EnvironmentRows {
	environment_row sky_rows[];
};

#include "common/sky_sample.glsl"

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
