// The grid of the voxels: struct voxel_grid of shared/voxel.h as a uniform block.
#ifndef VOXEL_GRID_BLOCK_GLSL
#define VOXEL_GRID_BLOCK_GLSL

#include "shared/voxel.h"

layout(std140, binding = UNIFORM_VOXEL_GRID) uniform VoxelGrid {
	vec4 grid_low_side;
	uvec4 grid_sides_entries;
};

#endif
