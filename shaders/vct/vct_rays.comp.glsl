// Indirect light of every pixel that traces (half.glsl): the diffuse part by rays, of which this pass traces some and adds them
// to those of the passes before it; the facets by a cone. Beside it the mean of 1 / distance over the rays, 1/m.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "vct/shared_rays.glsl"

layout(local_size_x = TILE_PIXELS) in;
layout(binding = VCT_IRRADIANCE_IMAGE, rgba32f) uniform image2D irradiance_image;
layout(binding = VCT_FACETS_IMAGE, rgba32ui) uniform writeonly uimage2D facets_image;
layout(binding = VCT_NEARNESS_IMAGE, r32f) uniform image2D nearness_image;

void main()
{
	uvec2 texel;
	if (!half_mine(texel))
		return;
	uvec2 pixel = half_pixel(texel);
	bool first = pixel_rays.x == 0u;
	visible_point v;
	surface s;
	bool lit = pixel_visible(pixel, v);
	if (lit) {
		s = pixel_surface(v);
		lit = !(EFFECT_UNLIT && s.unlit);
	}
	if (!lit) {
		imageStore(irradiance_image, ivec2(texel), vec4(0.0));
		return;
	}
	bsdf b = bsdf_make(s, v.direction);
	float near = 0.0;
	vec3 e = shared_irradiance(s, b, pixel, pixel_rays, near);
	near /= float(pixel_rays.z);
	if (!first) {
		e += imageLoad(irradiance_image, ivec2(texel)).rgb;
		near += imageLoad(nearness_image, ivec2(texel)).r;
	}
	imageStore(irradiance_image, ivec2(texel), vec4(e, v.t));
	imageStore(nearness_image, ivec2(texel), vec4(near));
	if (first)
		imageStore(facets_image, ivec2(texel),
			   uvec4(floatBitsToUint(indirect_facets(s, b, texel)), octahedral_pack(b.normal)));
	pixel_add_traced(pixel, vec3(0.0), rays_traced, trace_cut);
}
