// What a shading pass needs of a pixel: its visible surface, and where to add radiance. A pass is a compute shader over
// tiles:
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
#include "deferred/radiance.glsl"
#include "deferred/visible.glsl"

layout(binding = DEFERRED_VISIBILITY_UNIT) uniform usampler2D visibility;

// The hit of the pixel's ray. False if it hits nothing.
bool pixel_visible(uvec2 pixel, out visible_point v)
{
	v = visible_ray(pixel);
	uint id = texelFetch(visibility, pixel_texel(pixel), 0).x;
	return id != 0u && visible_at(v, id - 1u);
}

// The surface without the light that passes through its clear part: what remains are the opaque part and the reflection at
// the boundary, with Fresnel's reflectance after Schlick (1994), which is zero where light is not bent. Another pass adds
// the transmitted light.
surface without_clear(surface s)
{
	float r = (s.ior - 1.0) / (s.ior + 1.0);
	r *= r;
	r = s.thin ? 2.0 * r / (1.0 + r) : r;
	s.albedo *= 1.0 - s.transmission;
	s.f0 = mix(s.f0, vec3(r), s.transmission);
	s.f90 = mix(s.f90, vec3(min(50.0 * r, 1.0)), s.transmission);
	return s;
}

surface pixel_surface(visible_point v)
{
	surface s = surface_at(v.id, v.uv, v.origin, v.direction, v.t);
	if (EFFECT_GLASS)
		s = without_clear(s);
	return s;
}

#endif
