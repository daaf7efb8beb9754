// Indirect light of a pixel's surface by cones: the diffuse ones, and one about the mirror direction as wide as the facets
// scatter. The background comes by what the cones leave open.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "common/bsdf.glsl"
#include "direct/pixel.glsl"
#include "vct/cone.glsl"

layout(local_size_x = TILE_PIXELS) in;

// Part of a step by which a pixel's cones are shifted, −0.5…0.5: neighbours differ, 4 × 4 pixels have them all.
float pixel_shift(uvec2 pixel)
{
	uvec2 p = pixel & 3u;
	uint odd = (p.x ^ p.y) & 1u;
	uint far = (p.x ^ p.y) >> 1;
	return (float(odd << 3 | (p.y & 1u) << 2 | far << 1 | p.y >> 1) + 0.5) / 16.0 - 0.5;
}

vec3 facet_light(bsdf b, cone_origin o)
{
	vec3 l = vec3(-b.view.xy, b.view.z);
	vec3 w = l.x * b.x + l.y * b.y + l.z * b.normal;
	float above = dot(b.geometric, w);
	w = above < 0.0 ? w - 2.0 * above * b.geometric : w;
	// Half of what GGX's normals reflect lies within the half vector's angle of atan α (Walter et al. 2007); a sharper cone than
	// 1° would only show single cells.
	vec3 share = b.mirror ? schlick(b.f0, b.f90, b.view.z) : specular_albedo(b, ggx_albedo(b.view.z, b.roughness));
	return share * cone_radiance(o, w, clamp(b.alpha, 0.0087, 1.0));
}

void main()
{
	uvec2 pixel;
	visible_point v;
	if (!pixel_mine(pixel) || !pixel_visible(pixel, v))
		return;
	surface s = pixel_surface(v);
	if (EFFECT_UNLIT && s.unlit)
		return;
	bsdf b = bsdf_make(s, v.direction);
	cone_origin o = cone_from(s.position, s.geometric, pixel_shift(pixel));
	vec3 diffuse = b.diffuse;
	if (EFFECT_GLOSSY)
		diffuse *= 1.0 - specular_albedo(b, ggx_albedo(b.view.z, b.roughness));
	vec3 radiance = vec3(0.0);
	if (max(diffuse, vec3(0.0)) != vec3(0.0))
		radiance += diffuse * cone_irradiance(o, b.x, b.y, b.normal);
	if (EFFECT_GLOSSY && max(b.f0, b.f90) != vec3(0.0))
		radiance += facet_light(b, o);
	pixel_add(pixel, radiance);
}
