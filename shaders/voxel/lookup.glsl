// Reading voxels: from a place to its cell, from a cell to its entries, and their contents. For programs that run after the
// voxels are built. Layouts: shared/voxel.h. A storage block that a program does not use does not count against its limit.
#ifndef VOXEL_LOOKUP_GLSL
#define VOXEL_LOOKUP_GLSL

#include "shared/voxel.h"
#include "voxel/grid_block.glsl"
#include "voxel/octahedral.glsl"

layout(std430, binding = BIND_VOXEL_WORDS) readonly buffer VoxelWords {
	uvec2 voxel_words[];
};
layout(std430, binding = BIND_VOXEL_PLACE) readonly buffer VoxelPlace {
	uvec4 voxel_place[];
};
layout(std430, binding = BIND_VOXEL_ALBEDO) readonly buffer VoxelAlbedo {
	uvec4 voxel_albedo[];
};
layout(std430, binding = BIND_VOXEL_EMISSION) readonly buffer VoxelEmission {
	uvec4 voxel_emission[];
};
layout(std430, binding = BIND_VOXEL_COVERAGE) readonly buffer VoxelCoverage {
	uvec4 voxel_coverage[];
};

uvec3 voxel_sides()
{
	return grid_sides_entries.xyz;
}

uint voxel_entries()
{
	return grid_sides_entries.w;
}

float voxel_side()
{
	return grid_low_side.w;
}

// Converts between metres, relative to the blob's origin, and voxels from the grid's low corner.
vec3 voxel_from_metres(vec3 p)
{
	return (p - grid_low_side.xyz) / grid_low_side.w;
}

vec3 voxel_to_metres(vec3 v)
{
	return grid_low_side.xyz + v * grid_low_side.w;
}

bool voxel_is_inside(ivec3 cell)
{
	return all(greaterThanEqual(cell, ivec3(0))) && all(lessThan(cell, ivec3(grid_sides_entries.xyz)));
}

// The entry of a cell in a layer (0 or 1), or NONE. The cell must be inside of the grid.
uint voxel_entry(uvec3 cell, uint layer)
{
	uint bit = 2u * (cell.x + grid_sides_entries.x * (cell.y + grid_sides_entries.y * cell.z)) + layer;
	uvec2 word = voxel_words[bit >> 5];
	uint at = 1u << (bit & 31u);
	return (word.x & at) != 0u ? word.y + uint(bitCount(word.x & at - 1u)) : NONE;
}

// The layers in which a cell has entries: bit 0 for layer 0, bit 1 for layer 1. The cell must be inside of the grid.
uint voxel_layers(uvec3 cell)
{
	uint bit = 2u * (cell.x + grid_sides_entries.x * (cell.y + grid_sides_entries.y * cell.z));
	return voxel_words[bit >> 5].x >> (bit & 31u) & 3u;
}

// The cell of an entry; voxel_layer gives its layer.
uvec3 voxel_cell(uint entry)
{
	uint cell = voxel_albedo[entry].w >> 1;
	uvec3 sides = grid_sides_entries.xyz;
	return uvec3(cell % sides.x, cell / sides.x % sides.y, cell / sides.x / sides.y);
}

uint voxel_layer(uint entry)
{
	return voxel_albedo[entry].w & 1u;
}

vec3 voxel_position(uint entry)
{
	return uintBitsToFloat(voxel_place[entry].xyz);
}

vec3 voxel_normal(uint entry)
{
	return octahedral_unpack(voxel_place[entry].w);
}

vec3 voxel_diffuse_albedo(uint entry)
{
	return uintBitsToFloat(voxel_albedo[entry].xyz);
}

vec3 voxel_emitted(uint entry)
{
	return uintBitsToFloat(voxel_emission[entry].xyz);
}

// Whether the back of an entry emits as its front does, because some of its surfaces emit on both sides.
bool voxel_emits_back(uint entry)
{
	uint bits = voxel_emission[voxel_entries() + entry / VOXEL_BACK_BITS][entry / 32u % 4u];
	return (bits >> entry % 32u & 1u) != 0u;
}

// Surface area / side².
float voxel_area(uint entry)
{
	return uintBitsToFloat(voxel_emission[entry].w);
}

// Area / side² projected along each axis, separately for surfaces that face the axis' positive and negative end. Above 1
// where several surfaces lie behind each other.
void voxel_projections(uint entry, out vec3 plus, out vec3 minus)
{
	uvec4 c = voxel_coverage[entry];
	vec2 x = unpackHalf2x16(c.x);
	vec2 y = unpackHalf2x16(c.y);
	vec2 z = unpackHalf2x16(c.z);
	plus = vec3(x.x, y.x, z.x);
	minus = vec3(x.y, y.y, z.y);
}

#endif
