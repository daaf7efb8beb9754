// The cells of the pyramid's finest level that have entries, one after the other in any order: one invocation an entry, and the
// first entry of a cell puts it on the list.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "vct/cells.glsl"

layout(local_size_x = VCT_GROUP) in;
layout(location = VCT_RANGE) uniform uvec2 range;

layout(std430, binding = BIND_VCT_CELLS) buffer VctCells {
	uint vct_cells[];   // how many, then their numbers
};

void main()
{
	uint entry = range.x + gl_GlobalInvocationID.x;
	if (gl_GlobalInvocationID.x >= range.y)
		return;
	uvec3 cell = voxel_cell(entry) / 2u;
	uint first = NONE;
	for (uint k = 0u; k < 8u; k++) {
		uvec3 voxel = child_voxel(cell, k);
		uint layers = voxel_layers(voxel);
		if (first == NONE && layers != 0u)
			first = voxel_entry(voxel, (layers & 1u) != 0u ? 0u : 1u);
	}
	if (first == entry)
		vct_cells[1u + atomicAdd(vct_cells[0], 1u)] = cell_number(cell);
}
