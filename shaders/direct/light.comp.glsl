// Direct light with shadow rays.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "direct/light_pixel.glsl"

layout(local_size_x = TILE_PIXELS) in;

void main()
{
	light_pixel();
}
