// Indirect light at full resolution.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "vct/glass.glsl"

layout(local_size_x = TILE_PIXELS) in;

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
	pixel_add(pixel, indirect_radiance(b, indirect_at(s, b, pixel)));
	pixel_add_glass(pixel, s, v);
}
