// Sets the bit of every (cell, layer) that a triangle overlaps.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "voxel/grid.glsl"

layout(local_size_x = VOXEL_GROUP) in;

SCENE_BUFFER(BIND_VOXEL_WORDS) buffer VoxelWords {
	uvec2 voxel_words[];
};

void main()
{
	if (gl_GlobalInvocationID.x >= item_range.y)
		return;
	tile t = tile_of(items[item_range.x + gl_GlobalInvocationID.x]);
	uint layer = layer_of(t);
	walk w = walk_begin(t);
	ivec3 cell;
	while (walk_next(t, w, cell)) {
		uint bit = bit_of(t, cell, layer);
		if (bit != NONE)
			atomicOr(voxel_words[bit >> 5].x, 1u << (bit & 31u));
	}
}
