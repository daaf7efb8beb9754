// The pixels of a hemicube: where they are in its cell (shared/hemicube.h), and in which direction.
#ifndef RADIOSITY_HEMICUBE_GLSL
#define RADIOSITY_HEMICUBE_GLSL

#include "shared/hemicube.h"

layout(location = HEMICUBE_SIZES) uniform uvec4 sizes;
layout(std430, binding = BIND_HEMICUBE_CELLS) readonly buffer Cells {
	hemicube_cell hemicube_cells[];
};

vec3 hemicube_vec3(float v[3])
{
	return vec3(v[0], v[1], v[2]);
}

// The texel of a pixel of cell `cell`; `at` is its place within the cell.
ivec3 hemicube_texel(uint cell, uvec2 at)
{
	return ivec3(int(cell % sizes.y * 2u * sizes.x + at.x), int(at.y), int(cell / sizes.y));
}

// The face that a place in a cell is on: 0 the top, then sides +x, −x, +y, −y. `corner` is where the face begins.
uint hemicube_face(uvec2 at, out uvec2 corner)
{
	uint n = sizes.x;
	bool below = at.y >= n;
	bool right = at.x >= n;
	bool second = below ? right : at.y >= n / 2u;
	uint face = below ? (right ? 4u : 3u) : !right ? 0u : second ? 2u : 1u;
	corner = uvec2(right ? n : 0u, below ? n : face == 2u ? n / 2u : 0u);
	return face;
}

#endif
