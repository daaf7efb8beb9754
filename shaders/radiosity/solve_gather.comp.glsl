// The matrix of form factors times a vector of three channels: a subgroup sums a row, each lane four entries at a time, and
// the lanes' sums are added as a tree. So the order of a sum depends on the row alone.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require

#include "shared/solve.h"
#include "radiosity/pairs.glsl"

layout(local_size_x = SOLVE_LANES) in;
layout(constant_id = SPEC_GATHER_PAIRS) const bool PAIRS = false;

layout(push_constant) uniform Push {
	gather_push push;
};
layout(set = 0, binding = BIND_GATHER_COLUMNS) uniform utextureBuffer columns;
layout(set = 0, binding = BIND_GATHER_VALUES) uniform utextureBuffer values;
layout(set = 0, binding = BIND_GATHER_SOURCE) uniform utextureBuffer source;
layout(std430, set = 0, binding = BIND_GATHER_ROWS) readonly buffer Rows {
	solve_row rows[];
};
layout(std430, set = 0, binding = BIND_GATHER_SUMS) writeonly buffer Sums {
	vec4 sums[];
};

vec3 source_at(uint i)
{
	return uintBitsToFloat(texelFetch(source, int(i)).xyz);
}

void add_entry(inout vec3 hi, inout vec3 lo, uint column, float f)
{
	if (PAIRS)
		add_product(hi, lo, f, source_at(2u * column), source_at(2u * column + 1u));
	else
		hi += f * source_at(column);
}

void main()
{
	uint width = min(gl_SubgroupSize, uint(SOLVE_LANES));
	uint step = gl_NumWorkGroups.x * gl_NumSubgroups;
	for (uint i = push.first_row + gl_WorkGroupID.x * gl_NumSubgroups + gl_SubgroupID; i < push.end_row; i += step) {
		solve_row row = rows[i];
		uint end = (row.first + row.count + 3u) / 4u; // what is behind the row is 0
		vec3 hi = vec3(0.0), lo = vec3(0.0);
		for (uint at = row.first / 4u + gl_SubgroupInvocationID; at < end; at += width) {
			uvec4 column = texelFetch(columns, int(at));
			vec4 f = uintBitsToFloat(texelFetch(values, int(at)));
			add_entry(hi, lo, column.x, f.x);
			add_entry(hi, lo, column.y, f.y);
			add_entry(hi, lo, column.z, f.z);
			add_entry(hi, lo, column.w, f.w);
		}
		for (uint mask = width / 2u; mask > 0u; mask /= 2u) {
			vec3 other = subgroupShuffleXor(hi, mask);
			if (PAIRS) {
				vec3 lost, less = subgroupShuffleXor(lo, mask);
				hi = two_sum(hi, other, lost);
				lo += less + lost;
			} else {
				hi += other;
			}
		}
		if (PAIRS)
			settle_pair(hi, lo);
		if (gl_SubgroupInvocationID == 0u) {
			sums[2u * row.element] = vec4(hi, 0.0);
			if (PAIRS)
				sums[2u * row.element + 1u] = vec4(lo, 0.0);
		}
	}
}
