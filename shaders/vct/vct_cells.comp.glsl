// Lists the cells of the pyramid's finest level that have entries, in any order. One invocation for each entry; the first
// entry of a cell adds it to the list. Also sums the area of surfaces that bound walls too thin to hold the light.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "vct/cells.glsl"

layout(local_size_x = VCT_GROUP) in;
layout(location = VCT_RANGE) uniform uvec2 range;

layout(std430, binding = BIND_VCT_CELLS) buffer VctCells {
	uint vct_cells[];   // their number, then the cells, then the areas
};

const float ALIGNED = 0.99;    // component of a unit normal along an axis, from which the wall is aligned
const float OPPOSITE = -0.8;   // limit of the cosine between the normals of a wall's two faces
const float ROUNDING = 0.05;   // voxels

// Whether another face lies behind this one, facing the opposite way, so near that light leaks through the wall between
// them. Opposite faces are in different layers, so those of the thinnest wall are not mixed.
bool bounds_thin_wall(uint entry, uvec3 cell)
{
	vec3 normal = voxel_normal(entry);
	vec3 size = abs(normal);
	uint axis = size.x >= size.y && size.x >= size.z ? 0u : size.y >= size.z ? 1u : 2u;
	float thin = size[axis] > ALIGNED ? float(VCT_THIN_ALIGNED) : float(VCT_THIN_OBLIQUE);
	ivec3 inwards = ivec3(0);
	inwards[axis] = normal[axis] > 0.0 ? -1 : 1;
	bool found = false;
	int reach = int(ceil(thin / size[axis])) + 1;
	for (int i = 0; i <= reach; i++) {
		ivec3 at = ivec3(cell) + i * inwards;
		if (!voxel_is_inside(at))
			break;
		uint other = voxel_entry(uvec3(at), 1u - voxel_layer(entry));
		if (other == NONE)
			continue;
		float between = dot(voxel_position(entry) - voxel_position(other), normal) / voxel_side();
		bool opposite = dot(voxel_normal(other), normal) < OPPOSITE;
		found = found || opposite && between > -ROUNDING && between < thin - ROUNDING;
	}
	return found;
}

void main()
{
	uint entry = range.x + gl_GlobalInvocationID.x;
	if (gl_GlobalInvocationID.x >= range.y)
		return;
	uint area = uint(min(voxel_area(entry), float(VCT_AREA_MOST)) * float(VCT_AREA_UNITS) + 0.5);
	atomicAdd(vct_cells[voxel_entries() + 2u], area);
	if (bounds_thin_wall(entry, voxel_cell(entry)))
		atomicAdd(vct_cells[voxel_entries() + 1u], area);
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
