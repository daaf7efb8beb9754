// Counts the entries of each block of VOXEL_BLOCK_WORDS words. The host sums over the blocks.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "shared/voxel.h"

layout(local_size_x = VOXEL_WORD_GROUP) in;

layout(std430, binding = BIND_VOXEL_WORDS) readonly buffer VoxelWords {
	uvec2 voxel_words[];
};
layout(std430, binding = BIND_VOXEL_BLOCKS) writeonly buffer VoxelBlocks {
	uint blocks[];
};

// Number of words of the grid.
layout(location = 0) uniform uint words;

void main()
{
	uint first = gl_GlobalInvocationID.x * VOXEL_BLOCK_WORDS;
	if (first >= words)
		return;
	uint n = 0u;
	for (uint i = first; i < min(first + VOXEL_BLOCK_WORDS, words); i++)
		n += uint(bitCount(voxel_words[i].x));
	blocks[gl_GlobalInvocationID.x] = n;
}
