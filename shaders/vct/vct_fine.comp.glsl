// Interpolates indirect light from half to full resolution: a pixel takes that of the four nearest pixels that have it, as
// far as they lie on the same surface. Weights are bilinear, reduced for a different normal or plane (Kopf et al. 2007,
// "Joint bilateral upsampling"). A pixel without such neighbours traces its own cones, or rays.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "vct/half.glsl"
#include "vct/glass.glsl"
#ifdef VCT_RAYS
#include "vct/shared_rays.glsl"
#endif

layout(local_size_x = TILE_PIXELS) in;
layout(binding = VCT_IRRADIANCE_UNIT) uniform sampler2D irradiance_texture;
layout(binding = VCT_FACETS_UNIT) uniform usampler2D facets_texture;

const float LEAST_WEIGHT = 0.05;
const uint OWN_RAYS = 64u;   // most rays of a pixel without neighbours: it traces them all in one pass

// Adds a texel's light to r, by its weight.
void blend_in(surface s, vec3 normal, float breadth, ivec2 at, float part, inout indirect r, inout float sum)
{
	uvec2 texel = uvec2(clamp(at, ivec2(0), ivec2(half_sides()) - 1));
	vec4 irradiance = texelFetch(irradiance_texture, ivec2(texel), 0);
	uvec4 facets = texelFetch(facets_texture, ivec2(texel), 0);
	vec3 apart = half_apart(s.position, texel, irradiance.a);
	float w = part * half_kinship(apart, s.geometric, normal, breadth, irradiance, facets);
	r.irradiance += w * irradiance.rgb;
	r.facets += w * uintBitsToFloat(facets.rgb);
	sum += w;
}

// False if there is no light of the same surface nearby.
bool blend(surface s, bsdf b, visible_point v, uvec2 pixel, out indirect r)
{
	vec2 at = vec2(pixel - uvec2(0u, area.x)) / float(VCT_EVERY);
	ivec2 base = ivec2(at);
	vec2 f = at - vec2(base);
	float breadth = half_breadth(v.t);
	r = indirect(vec3(0.0), vec3(0.0));
	float sum = 0.0;
	for (int k = 0; k < 4; k++) {
		ivec2 step = ivec2(k & 1, k >> 1);
		vec2 part = mix(1.0 - f, f, bvec2(step));
		blend_in(s, b.normal, breadth, base + step, part.x * part.y, r, sum);
	}
#ifdef VCT_RAYS
	// A pixel's own rays are few. At edges, those of a place a little farther off say more. Among the rows are none but these:
	// a band has TILE_SIDE rows beyond its own, and the texel below has taken a share of VCT_SHARE_SIDE - 1 below it.
	for (int k = 0; k < 12 && sum < LEAST_WEIGHT; k++)
		blend_in(s, b.normal, breadth, base + ivec2(k & 3, k >> 2) - 1, 1.0, r, sum);
#endif
	r.irradiance /= max(sum, 1e-6);
	r.facets /= max(sum, 1e-6);
	return sum > LEAST_WEIGHT;
}

// Adds to the pixel what its surface reflects, by light of its own unless it has been blended.
void add_light(surface s, bsdf b, uvec2 pixel, bool blended, indirect r)
{
#ifdef VCT_RAYS
	uint all = min(pixel_rays.z, OWN_RAYS);
	float nearness = 0.0;
	if (!blended)
		r = indirect(shared_irradiance(s, b, pixel, uvec3(0u, all, all), nearness), indirect_facets(s, b, pixel));
	pixel_add_traced(pixel, indirect_radiance(b, r), rays_traced, trace_cut);
#else
	if (!blended)
		r = indirect_at(s, b, pixel);
	pixel_add(pixel, indirect_radiance(b, r));
#endif
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
	indirect r;
	bool blended = blend(s, b, v, pixel, r);
	add_light(s, b, pixel, blended, r);
	pixel_add_glass(pixel, s, v);
}
