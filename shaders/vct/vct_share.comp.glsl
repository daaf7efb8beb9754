// Shares the rays of neighbours. A pixel that traces takes the mean of those around it on the same surface: irradiance alone, so
// that albedo, which is another pass's, stays sharp. Weights fall linearly to nothing at VCT_SHARE_SIDE pixels that trace, so
// those of each part of a set of rays add up to the same: on a flat surface all parts count alike. Near other surfaces light
// changes faster, so there the reach is the distance of what the rays met, in the harmonic mean (Ward, Rubinstein and Clear
// 1988).
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "vct/half.glsl"

layout(local_size_x = TILE_PIXELS) in;
layout(binding = VCT_IRRADIANCE_UNIT) uniform sampler2D irradiance_texture;
layout(binding = VCT_FACETS_UNIT) uniform usampler2D facets_texture;
layout(binding = VCT_NEARNESS_UNIT) uniform sampler2D nearness_texture;
layout(binding = VCT_IRRADIANCE_IMAGE, rgba32f) uniform writeonly image2D irradiance_image;

const int REACH = VCT_SHARE_SIDE - 1;
const int ACROSS = 2 * REACH + 1;

vec3 mean_around(uvec2 texel, visible_point v, vec4 own)
{
	vec3 position = v.origin + own.a * v.direction;
	vec3 geometric = corners_of(triangles[v.id]).normal;
	vec3 normal = octahedral_unpack(texelFetch(facets_texture, ivec2(texel), 0).a);
	float near = texelFetch(nearness_texture, ivec2(texel), 0).r;
	float breadth = half_breadth(v.t);
	ivec2 sides = ivec2(half_sides());
	vec4 sum = vec4(0.0);
	for (int i = 0; i < ACROSS * ACROSS; i++) {
		ivec2 step = ivec2(i % ACROSS, i / ACROSS) - REACH;
		ivec2 at = ivec2(texel) + step;
		if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, sides)))
			continue;
		vec4 irradiance = texelFetch(irradiance_texture, at, 0);
		vec3 apart = half_apart(position, uvec2(at), irradiance.a);
		vec2 tent = 1.0 - abs(vec2(step)) / float(VCT_SHARE_SIDE);
		float w = half_kinship(apart, geometric, normal, breadth, irradiance, texelFetch(facets_texture, at, 0));
		w *= tent.x * tent.y * max(1.0 - length(apart) * near, 0.0);
		sum += w * vec4(irradiance.rgb, 1.0);
	}
	return sum.a > 0.0 ? sum.rgb / sum.a : own.rgb;
}

void main()
{
	uvec2 texel;
	if (!half_mine(texel))
		return;
	vec4 own = texelFetch(irradiance_texture, ivec2(texel), 0);
	visible_point v;
	if (own.a > 0.0 && pixel_visible(half_pixel(texel), v))
		own.rgb = mean_around(texel, v, own);
	imageStore(irradiance_image, ivec2(texel), own);
}
