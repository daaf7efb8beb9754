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

// What a place gives back along the ray that met it, without what its mirror shows.
struct seen {
	vec3 reflected; // W/(m² sr)
	vec3 shining;   // it emits that, or is unlit, W/(m² sr)
	float power;    // as a lamp's, material.power_density; 0: it is none
	float share;    // mirror_share
};

seen place_seen(place p)
{
	material m = material_fetch(p.tri.material);
	vec4 at = place_coordinates(p);
	vec3 base = clamp(base_color_at(m, p.tri, vec3(1.0 - p.uv.x - p.uv.y, p.uv), at).rgb, 0.0, 1.0);
	seen s;
	s.share = mirror_share(m, at);
	s.reflected = base * ((1.0 - s.share) * (1.0 / PI)) * value_at(p.id, p.uv, p.front);
	bool unlit = EFFECT_UNLIT && (m.flags & MATERIAL_UNLIT) != 0u;
	s.reflected = unlit ? vec3(0.0) : s.reflected;
	s.shining = unlit ? base : vec3(0.0);
	bool shines = EFFECT_EMITTERS && (p.front || (m.flags & MATERIAL_EMITS_BOTH_SIDES) != 0u);
	if (!RADIOSITY_LIT_TEXTURES)
		m.emission_texture = NONE;
	s.shining += shines ? emission_at(m, at) : vec3(0.0);
	s.power = shines ? m.power_density : 0.0;
	return s;
}

#endif
