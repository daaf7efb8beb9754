// Cells of the pyramid's finest level. Each is two by two by two voxels; along an axis with a single voxel, one.
#ifndef VCT_CELLS_GLSL
#define VCT_CELLS_GLSL

#include "vct/params.glsl"
#include "voxel/lookup.glsl"

uint cell_number(uvec3 cell)
{
	return cell.x + vct_sides_top.x * (cell.y + vct_sides_top.y * cell.z);
}

uvec3 cell_of(uint number)
{
	uvec3 sides = vct_sides_top.xyz;
	return uvec3(number % sides.x, number / sides.x % sides.y, number / sides.x / sides.y);
}

// Voxel k of a cell: bits 0, 1 and 2 of k select the upper voxel along x, y, z.
uvec3 child_voxel(uvec3 cell, uint k)
{
	return min(2u * cell + uvec3(k & 1u, k >> 1 & 1u, k >> 2), voxel_sides() - 1u);
}

#endif
