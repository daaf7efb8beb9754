// What a shading pass sees of a pixel, and where its light goes. A pass is a compute shader over tiles:
//
//   layout(local_size_x = TILE_PIXELS) in;
//   void main()
//   {
//       uvec2 pixel;
//       visible_point v;
//       surface s;
//       if (pixel_mine(pixel) && pixel_visible(pixel, v)) { s = pixel_surface(v); … pixel_add(pixel, radiance); }
//   }
#ifndef DIRECT_PIXEL_GLSL
#define DIRECT_PIXEL_GLSL

#include "common/surface.glsl"
#include "direct/radiance.glsl"
#include "direct/visible.glsl"

layout(binding = DEFERRED_VISIBILITY_UNIT) uniform usampler2D visibility;

// What its ray meets; false: nothing.
bool pixel_visible(uvec2 pixel, out visible_point v)
{
	v = visible_ray(pixel);
	uint id = texelFetch(visibility, pixel_texel(pixel), 0).x;
	return id != 0u && visible_at(v, id - 1u);
}

surface pixel_surface(visible_point v)
{
	return surface_at(v.id, v.uv, v.direction);
}

#endif
