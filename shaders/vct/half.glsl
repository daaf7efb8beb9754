// Indirect light of every second pixel of every second row, in two textures: (irradiance / π, distance along the pixel's ray),
// and (facets' radiance, bits of the shading normal). Distance 0: nothing there.
#ifndef VCT_HALF_GLSL
#define VCT_HALF_GLSL

#include "vct/indirect.glsl"
#include "voxel/octahedral.glsl"

// Texels of the band whose pixels are the area's.
uvec2 half_sides()
{
	return (uvec2(turn.w, area.y) + 1u) / 2u;
}

// The pixel that a texel stands for.
uvec2 half_pixel(uvec2 texel)
{
	return 2u * texel + uvec2(0u, area.x);
}

#endif
