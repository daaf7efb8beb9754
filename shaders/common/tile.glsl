// A workgroup of a compute shader works on a tile of the image.
#ifndef COMMON_TILE_GLSL
#define COMMON_TILE_GLSL

#include "shared/bindings.h"

// The pixel of this invocation in tile number `tile` of an image with `columns` columns of tiles. Eight consecutive
// invocations are a block of 4 × 2 pixels, so that the rays of a subgroup start close together.
uvec2 tile_pixel(uint tile, uint columns)
{
	uint i = gl_LocalInvocationIndex;
	uint block = i / 8u;
	uvec2 inside = uvec2(block % 2u * 4u + i % 4u, block / 2u * 2u + i / 4u % 2u);
	return uvec2(tile % columns, tile / columns) * TILE_SIDE + inside;
}

#endif
