// Indirect light at half resolution (every second pixel of every second row), by cones. Its tiles are those of the half picture,
// because an idle lane costs as much as a busy one.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "vct/half.glsl"

layout(local_size_x = TILE_PIXELS) in;
layout(binding = VCT_IRRADIANCE_IMAGE, rgba32f) uniform writeonly image2D irradiance_image;
layout(binding = VCT_FACETS_IMAGE, rgba32ui) uniform writeonly uimage2D facets_image;

void main()
{
	uvec2 texel;
	if (!half_mine(texel))
		return;
	uvec2 pixel = half_pixel(texel);
	visible_point v;
	indirect r = indirect(vec3(0.0), vec3(0.0));
	float t = 0.0;
	uint normal = 0u;
	if (pixel_visible(pixel, v)) {
		surface s = pixel_surface(v);
		bsdf b = bsdf_make(s, v.direction);
		if (!(EFFECT_UNLIT && s.unlit)) {
			r = indirect_at(s, b, texel);
			t = v.t;
			normal = octahedral_pack(b.normal);
		}
	}
	imageStore(irradiance_image, ivec2(texel), vec4(r.irradiance, t));
	imageStore(facets_image, ivec2(texel), uvec4(floatBitsToUint(r.facets), normal));
}
