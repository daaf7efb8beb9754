// What a ray of a picture of radiosity sees, by the light that is known of elements.
#ifndef RADIOSITY_SEEN_GLSL
#define RADIOSITY_SEEN_GLSL

#include "radiosity/lookup.glsl"
#include "radiosity/matter.glsl"
#include "radiosity/place.glsl"
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

// Whether some material has a texture of its emission; a macro that the program defines.
#ifndef RADIOSITY_LIT_TEXTURES
#define RADIOSITY_LIT_TEXTURES true
#endif

// What a place gives back along the ray that met it, without what its mirror shows, W/(m² sr). `plain`: the ray has come from
// the camera, if by mirrors, and sees what shines; otherwise only what is reflected counts. `share` is mirror_share.
vec3 place_seen(place p, bool plain, out float share)
{
	material m = material_fetch(p.tri.material);
	vec4 at = place_coordinates(p);
	vec3 base = clamp(base_color_at(m, p.tri, vec3(1.0 - p.uv.x - p.uv.y, p.uv), at).rgb, 0.0, 1.0);
	share = mirror_share(m, at);
	vec3 seen = base * ((1.0 - share) * (1.0 / PI)) * value_at(p.id, p.uv, p.front);
	if (EFFECT_UNLIT && (m.flags & MATERIAL_UNLIT) != 0u)
		seen = plain ? base : vec3(0.0);
	bool shines = plain && EFFECT_EMITTERS && (p.front || (m.flags & MATERIAL_EMITS_BOTH_SIDES) != 0u);
	if (!RADIOSITY_LIT_TEXTURES)
		m.emission_texture = NONE;
	return seen + (shines ? emission_at(m, at) : vec3(0.0));
}

#endif
