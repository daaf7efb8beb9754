// Indirect light at half resolution (every second pixel of every second row), in two textures: (irradiance / π, distance
// along the pixel's ray) and, as words, (incoming radiance for the facets, packed shading normal). Distance 0: nothing there.
#ifndef VCT_HALF_GLSL
#define VCT_HALF_GLSL

#include "vct/indirect.glsl"
#include "voxel/octahedral.glsl"

// Texels that cover the pixels of the band.
uvec2 half_sides()
{
	return (uvec2(turn.w, area.y) + 1u) / 2u;
}

// The pixel that a texel represents.
uvec2 half_pixel(uvec2 texel)
{
	return 2u * texel + uvec2(0u, area.x);
}

#endif
