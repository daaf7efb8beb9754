// Indirect light of a pixel, from other surfaces and the background: the diffuse cones, and one about the mirror direction,
// as wide as the facets scatter.
#ifndef VCT_INDIRECT_GLSL
#define VCT_INDIRECT_GLSL

#include "common/bsdf.glsl"
#include "deferred/pixel.glsl"
#include "vct/cone.glsl"

struct indirect {
	vec3 irradiance;   // irradiance / π about the shading normal
	vec3 facets;       // incoming radiance for the facets, before their albedo
};

// The shift of a pixel's cones, as a share of a step, −0.5…0.5. Neighbours differ; 4 × 4 pixels take all values.
float pixel_shift(uvec2 pixel)
{
	uvec2 p = pixel & 3u;
	uint odd = (p.x ^ p.y) & 1u;
	uint far = (p.x ^ p.y) >> 1;
	return (float(odd << 3 | (p.y & 1u) << 2 | far << 1 | p.y >> 1) + 0.5) / 16.0 - 0.5;
}

vec3 mirror_direction(bsdf b)
{
	vec3 l = vec3(-b.view.xy, b.view.z);
	vec3 w = l.x * b.x + l.y * b.y + l.z * b.normal;
	float above = dot(b.geometric, w);
	return above < 0.0 ? w - 2.0 * above * b.geometric : w;
}

// Incoming radiance for the facets, by a cone about the mirror direction.
vec3 facets_from(cone_origin o, bsdf b)
{
	// Half of what GGX's normals reflect lies where the half vector's angle is below atan α (Walter et al. 2007). A
	// cone sharper than 1° would only show single cells.
	if (EFFECT_GLOSSY && max(b.gloss.f0, b.gloss.f90) != vec3(0.0))
		return cone_radiance(o, mirror_direction(b), clamp(b.gloss.alpha, 0.0087, 1.0));
	return vec3(0.0);
}

vec3 indirect_facets(surface s, bsdf b, uvec2 pixel)
{
	return facets_from(cone_from(s.position, s.geometric, pixel_shift(pixel)), b);
}

indirect indirect_at(surface s, bsdf b, uvec2 pixel)
{
	cone_origin o = cone_from(s.position, s.geometric, pixel_shift(pixel));
	indirect r = indirect(vec3(0.0), vec3(0.0));
	if (max(b.diffuse, vec3(0.0)) != vec3(0.0))
		r.irradiance = cone_irradiance(o, b.x, b.y, b.normal);
	r.facets = facets_from(o, b);
	return r;
}

// Radiance, W/(m² sr), that the surface reflects towards the camera.
vec3 indirect_radiance(bsdf b, indirect r)
{
	if (!EFFECT_GLOSSY)
		return b.diffuse * r.irradiance;
	vec3 specular = facets_albedo(b.gloss, ggx_albedo(b.view.z, b.gloss.roughness));
	vec3 share = b.gloss.mirror ? facets_mirrored(b.gloss, b.view.z) : specular;
	return b.diffuse * (1.0 - specular) * r.irradiance + share * r.facets;
}

#endif
