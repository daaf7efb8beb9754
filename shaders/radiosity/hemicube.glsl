// The pixels of a hemicube: where they are in its cell (shared/hemicube.h), and in which direction.
#ifndef RADIOSITY_HEMICUBE_GLSL
#define RADIOSITY_HEMICUBE_GLSL

#include "shared/hemicube.h"

layout(location = HEMICUBE_SIZES) uniform uvec3 sizes;
layout(std430, binding = BIND_HEMICUBE_CELLS) readonly buffer Cells {
	hemicube_cell hemicube_cells[];
};

vec3 hemicube_vec3(float v[3])
{
	return vec3(v[0], v[1], v[2]);
}

// A pixel's place in its cell: x and y in its layer, and the layer.
uvec3 hemicube_place(uint pixel)
{
	uint n = sizes.x;
	return uvec3(pixel % n, pixel / n % n, pixel / (n * n));
}

// The texel of a place in cell `cell`.
ivec3 hemicube_texel(uint cell, uvec3 place)
{
	return ivec3(place.xy, cell * HEMICUBE_LAYERS + place.z);
}

// The face that a place in a cell is on: 0 the top, then sides +x, −x, +y, −y; and where on that face.
uint hemicube_face(uvec3 place, out uvec2 at)
{
	uint half_n = sizes.x / 2u;
	bool upper = place.z > 0u && place.y >= half_n;
	at = uvec2(place.x, upper ? place.y - half_n : place.y);
	return place.z == 0u ? 0u : 2u * place.z - (upper ? 0u : 1u);
}

#endif
