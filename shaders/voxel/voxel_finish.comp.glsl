// Converts the sums to what shading reads, in the same memory. One invocation for each word.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "shared/voxel.h"

layout(local_size_x = VOXEL_WORD_GROUP) in;

layout(std140, binding = UNIFORM_VOXEL_GRID) uniform VoxelGrid {
	vec4 grid_low_side;
	uvec4 grid_sides_entries;
};
layout(std430, binding = BIND_VOXEL_WORDS) readonly buffer VoxelWords {
	uvec2 voxel_words[];
};
layout(std430, binding = BIND_VOXEL_PLACE) buffer Place {
	uvec4 place[];
};
layout(std430, binding = BIND_VOXEL_ALBEDO) buffer Albedo {
	uvec4 albedo[];
};
layout(std430, binding = BIND_VOXEL_EMISSION) buffer Emission {
	uvec4 emission[];
};
layout(std430, binding = BIND_VOXEL_COVERAGE) buffer Coverage {
	uvec4 coverage[];
};

// Number of words of the grid.
layout(location = 0) uniform uint words;
// x: 1 / units of area; y: radiance of one unit of emission per unit of area.
layout(location = 1) uniform vec2 unit_sizes;
// First word of this dispatch.
layout(location = 2) uniform uint first_word;

#include "voxel/octahedral.glsl"

vec3 cell_middle(uint bit)
{
	uvec3 sides = grid_sides_entries.xyz;
	uint cell = bit >> 1;
	return vec3(cell % sides.x, cell / sides.x % sides.y, cell / sides.x / sides.y) + 0.5;
}

// The normalised sum of normals. Where they cancel, an axis that agrees with the layer's sign.
vec3 mean_normal(vec3 n, uint layer)
{
	float l = length(n);
	return l > 1e-12 ? n / l : vec3(0.0, layer == 1u ? -1.0 : 1.0, 0.0);
}

void finish_entry(uint e, uint bit)
{
	uvec4 p = place[e];
	uvec4 a = albedo[e];
	uvec4 m = emission[e];
	uvec4 c = coverage[e];
	// Half floats end at 65504. Infinite coverage would make light of 0 × infinity.
	vec3 plus = min(vec3(a.w, c.x, c.z) * unit_sizes.x, 65504.0);
	vec3 minus = min(vec3(m.w, c.y, c.w) * unit_sizes.x, 65504.0);
	float weight = float(p.x);
	float inverse = p.x > 0u ? 1.0 / weight : 0.0;
	vec3 within = p.x > 0u ? vec3(p.yzw) * inverse : vec3(0.5);
	vec3 at = grid_low_side.xyz + grid_low_side.w * (cell_middle(bit) + (within - 0.5));
	place[e] = uvec4(floatBitsToUint(at), octahedral_pack(mean_normal(plus - minus, bit & 1u)));
	albedo[e] = uvec4(floatBitsToUint(min(vec3(a.xyz) * inverse, 1.0)), bit);
	float area = weight * unit_sizes.x;
	vec3 radiance = p.x > 0u ? vec3(m.xyz) * (unit_sizes.y / area) : vec3(0.0);
	emission[e] = uvec4(floatBitsToUint(radiance), floatBitsToUint(area));
	coverage[e] = uvec4(packHalf2x16(vec2(plus.x, minus.x)), packHalf2x16(vec2(plus.y, minus.y)),
			    packHalf2x16(vec2(plus.z, minus.z)), 0u);
}

void main()
{
	uint word = first_word + gl_GlobalInvocationID.x;
	if (word >= words)
		return;
	uint bits = voxel_words[word].x;
	uint e = voxel_words[word].y;
	while (bits != 0u) {
		uint i = uint(findLSB(bits));
		finish_entry(e, 32u * word + i);
		bits &= bits - 1u;
		e++;
	}
}
