// Computes the number of entries before each word from the number before its block.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "shared/voxel.h"

layout(local_size_x = VOXEL_WORD_GROUP) in;

layout(std430, binding = BIND_VOXEL_WORDS) buffer VoxelWords {
	uvec2 voxel_words[];
};
layout(std430, binding = BIND_VOXEL_BLOCKS) readonly buffer VoxelBlocks {
	uint blocks[];
};

// Number of words of the grid.
layout(location = 0) uniform uint words;

void main()
{
	uint first = gl_GlobalInvocationID.x * VOXEL_BLOCK_WORDS;
	if (first >= words)
		return;
	uint n = blocks[gl_GlobalInvocationID.x];
	for (uint i = first; i < min(first + VOXEL_BLOCK_WORDS, words); i++) {
		voxel_words[i].y = n;
		n += uint(bitCount(voxel_words[i].x));
	}
}
