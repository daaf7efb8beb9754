// What radiosity makes of a surface: part of it is a mirror, the metallic part of a polished metal; the rest is diffuse, of
// its base colour. Microfacets, coats and clear boundaries are left out.
#ifndef RADIOSITY_MATTER_GLSL
#define RADIOSITY_MATTER_GLSL

#include "common/facets.glsl"
#include "common/surface.glsl"
#include "shared/patch_pass.h"

// Reflections at mirrors that a ray follows, at most; 0: there are no mirrors. A macro that the program defines.
#ifndef RADIOSITY_BOUNCES
#define RADIOSITY_BOUNCES 2
#endif

// The share of a surface that is a mirror, 0…1; `at` are its texture coordinates.
float mirror_share(material m, vec4 at)
{
	if (RADIOSITY_BOUNCES == 0 || (EFFECT_UNLIT && (m.flags & MATERIAL_UNLIT) != 0u))
		return 0.0;
	float metallic = m.metallic;
	float roughness = m.roughness;
	if (EFFECT_TEXTURES && m.surface_texture != NONE) {
		vec4 t = sample_texture(m.surface_texture, at);
		roughness *= t.g;
		metallic *= t.b;
	}
	return roughness * roughness <= PATCH_MIRROR_ALPHA ? metallic : 0.0;
}

float mirror_share_at(uint id, vec2 uv)
{
	triangle tri = triangles[id];
	vec4 at = EFFECT_TEXTURES ? coordinates_at(tri, vec3(1.0 - uv.x - uv.y, uv)) : vec4(0.0);
	return mirror_share(materials[tri.material], at);
}

// The mirror's reflectance for a ray along `direction`: Fresnel's for metals after Schlick (1994), as the path tracer has it.
vec3 mirror_reflectance(surface s, float share, vec3 direction)
{
	return share * schlick(s.base, vec3(1.0), clamp(-dot(s.shading, direction), 0.0, 1.0));
}

// The direction in which a ray goes on, kept above the surface.
vec3 mirrored(surface s, vec3 direction)
{
	vec3 w = reflect(direction, s.shading);
	float above = dot(w, s.geometric);
	return above < 0.0 ? w - 2.0 * above * s.geometric : w;
}

// The surface as passes of direct light take it: its diffuse part alone.
surface without_specular(surface s, float share)
{
	s.albedo = s.base * (1.0 - share);
	s.f0 = vec3(0.0);
	s.f90 = vec3(0.0);
	s.roughness = 1.0;
	s.transmission = 0.0;
	s.coat = 0.0;
	return s;
}

#endif
