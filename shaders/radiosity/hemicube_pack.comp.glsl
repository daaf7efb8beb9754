// Rows of sums become lists of entries, one workgroup a row, and the sums zero again. Which row's list comes first is up to
// chance, as the order within a list is; the host sorts them.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "shared/hemicube.h"

layout(local_size_x = HEMICUBE_LANES) in;

layout(location = HEMICUBE_SIZES) uniform uvec3 sizes;
layout(std430, binding = BIND_HEMICUBE_DENSE) buffer Dense {
	uint dense[];
};
layout(std430, binding = BIND_HEMICUBE_ROWS) buffer Rows {
	hemicube_row rows[];
};
layout(std430, binding = BIND_HEMICUBE_LISTS) readonly buffer Lists {
	uint lists[];
};
layout(std430, binding = BIND_HEMICUBE_ENTRIES) writeonly buffer Entries {
	hemicube_entry entries[];
};

void main()
{
	uint row = gl_WorkGroupID.x;
	uint count = rows[row].count;
	uint first = rows[row].first;
	for (uint i = gl_LocalInvocationIndex; i < count; i += HEMICUBE_LANES) {
		uint element = lists[row * sizes.z + i];
		uint at = 2u * (row * sizes.y + element);
		entries[first + i].element = element;
		entries[first + i].weight[0] = dense[at];
		entries[first + i].weight[1] = dense[at + 1u] & ~HEMICUBE_MET;
		dense[at] = dense[at + 1u] = 0u;
	}
}
