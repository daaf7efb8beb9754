// Direct light with shadows from the voxels.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "vct/shadow.glsl"
#include "direct/light_pixel.glsl"

layout(local_size_x = TILE_PIXELS) in;

void main()
{
	light_pixel();
}
