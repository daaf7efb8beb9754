// Direct light on what of surfaces is diffuse, in a final gather. Lamps, background and unlit surfaces are seen here, too.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "deferred/pixel.glsl"
#include "radiosity/matter.glsl"

surface diffuse_surface(visible_point v)
{
	surface s = surface_at(v.id, v.uv, v.origin, v.direction, v.t);
	return without_specular(s, mirror_share_at(v.id, v.uv));
}
#define LIGHT_SURFACE diffuse_surface
#include "direct/light_pixel.glsl"

layout(local_size_x = TILE_PIXELS) in;

void main()
{
	light_pixel();
}
