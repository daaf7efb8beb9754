// Copies the sums of what did not move into those of an edited scene, whose words determine the places. One invocation for
// each word.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "shared/voxel.h"

layout(local_size_x = VOXEL_WORD_GROUP) in;

layout(std430, binding = BIND_VOXEL_FIXED_WORDS) readonly buffer FixedWords {
	uvec2 fixed_words[];
};
layout(std430, binding = BIND_VOXEL_FIXED_PARTS) readonly buffer FixedPlace {
	uvec4 fixed_place[];
};
layout(std430, binding = BIND_VOXEL_FIXED_PARTS + 1) readonly buffer FixedAlbedo {
	uvec4 fixed_albedo[];
};
layout(std430, binding = BIND_VOXEL_FIXED_PARTS + 2) readonly buffer FixedEmission {
	uvec4 fixed_emission[];
};
layout(std430, binding = BIND_VOXEL_FIXED_PARTS + 3) readonly buffer FixedCoverage {
	uvec4 fixed_coverage[];
};
layout(std430, binding = BIND_VOXEL_WORDS) readonly buffer VoxelWords {
	uvec2 voxel_words[];
};
layout(std430, binding = BIND_VOXEL_PLACE) writeonly buffer Place {
	uvec4 place[];
};
layout(std430, binding = BIND_VOXEL_ALBEDO) writeonly buffer Albedo {
	uvec4 albedo[];
};
layout(std430, binding = BIND_VOXEL_EMISSION) buffer Emission {
	uint emission[];
};
layout(std430, binding = BIND_VOXEL_COVERAGE) writeonly buffer Coverage {
	uvec4 coverage[];
};

// Number of words of the grid.
layout(location = 0) uniform uint words;
// Number of entries of what did not move, and of all.
layout(location = 1) uniform uvec2 entries;
// First word of this dispatch.
layout(location = 2) uniform uint first_word;

void main()
{
	uint word = first_word + gl_GlobalInvocationID.x;
	if (word >= words)
		return;
	uvec2 to = voxel_words[word];
	uint bits = fixed_words[word].x;
	uint from = fixed_words[word].y;
	while (bits != 0u) {
		uint at = bits & ~(bits - 1u);
		uint entry = to.y + uint(bitCount(to.x & at - 1u));
		place[entry] = fixed_place[from];
		albedo[entry] = fixed_albedo[from];
		uvec4 emitted = fixed_emission[from];
		for (uint c = 0u; c < 4u; c++)
			emission[4u * entry + c] = emitted[c];
		uint back = fixed_emission[entries.x + from / VOXEL_BACK_BITS][from / 32u % 4u] >> from % 32u & 1u;
		atomicOr(emission[4u * entries.y + entry / 32u], back << entry % 32u);
		coverage[entry] = fixed_coverage[from];
		bits &= bits - 1u;
		from++;
	}
}
