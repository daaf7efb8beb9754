// What a ray of a picture of radiosity sees, by the light that is known of elements.
#ifndef RADIOSITY_SEEN_GLSL
#define RADIOSITY_SEEN_GLSL

#include "radiosity/lookup.glsl"
#include "radiosity/matter.glsl"
#ifdef RADIOSITY_SKY
#include "common/sky_map.glsl"
#endif

// What is behind the scene, W/(m² sr).
vec3 background_seen(vec3 direction)
{
#ifdef RADIOSITY_SKY
	return sky_seen(direction, job.sky_turn) * job.sky_scale;
#else
	return EFFECT_ENVIRONMENT ? to_vec3(job.background) : vec3(0.0);
#endif
}

// What a surface gives back along the ray that met it at uv on triangle `id`, without what its mirror shows, W/(m² sr).
// `plain`: the ray has come from the camera, if by mirrors, and sees what shines; otherwise only what is reflected counts.
vec3 surface_seen(surface s, uint id, vec2 uv, float share, bool plain)
{
	vec3 reflected = s.base * ((1.0 - share) * (1.0 / PI)) * value_at(id, uv, s.front);
	if (EFFECT_UNLIT && s.unlit)
		reflected = plain ? s.base : vec3(0.0);
	return reflected + (plain ? s.emission : vec3(0.0));
}

#endif
