// The bounce from surface to surface by rays: traces those of both sides of every entry, which look up what the sides have
// sent so far, and adds what they find to the light from the lights.
#version 450 core
#extension GL_GOOGLE_include_directive : require
#define SCENE_WITHOUT_LAMPS

#include "vct/entry.glsl"
#include "vct/rays.glsl"
#include "voxel/octahedral.glsl"

layout(local_size_x = VCT_GROUP) in;
layout(location = VCT_RANGE) uniform uvec2 range;
layout(binding = VCT_PLACE_UNIT) uniform usamplerBuffer vct_place;

layout(std430, binding = BIND_VCT_DIRECT) buffer VctDirect {
	uint vct_direct[];
};
layout(std430, binding = BIND_VCT_TOTAL) writeonly buffer VctTotal {
	float vct_total[];
};

// The part of a set of rays that an entry traces: it differs among the four voxels of any two by two that lie in a plane across
// an axis. `block` is the cell of two by two by two voxels, whose entries share the set.
uint part_of(uint entry, out uint block)
{
	uint number = texelFetch(vct_albedo, int(entry)).w >> 1;
	uvec3 sides = grid_sides_entries.xyz;
	uvec3 v = entry_voxel(number, sides);
	uvec3 cell = v >> 1;
	block = cell.x + sides.x * (cell.y + sides.y * cell.z);
	return entry_group(v);
}

void main()
{
	uint item = range.x + gl_GlobalInvocationID.x;
	if (gl_GlobalInvocationID.x >= range.y)
		return;
	uint entry = item >> 1;
	uint side = item & 1u;
	uvec4 place = texelFetch(vct_place, int(entry));
	vec3 normal = octahedral_unpack(place.w);
	rays_origin o;
	o.geometric = side == 0u ? normal : -normal;
	o.shading = o.geometric;
	// As for the lights: the mean position of a curved surface lies slightly inside of it.
	o.position = uintBitsToFloat(place.xyz) + 0.25 * grid_low_side.w * o.geometric;
	uint block;
	uint part = part_of(entry, block);
	sampler_state random = sampler_make(block, side, 0u, 0u, 0u);
	float nearness = 0.0;
	vec3 e = entry_bounded(PI * rays_irradiance(o, random, part, 0u, vct_rays.x, vct_rays.x, nearness));
	uint at = entry * VCT_ENTRY_FLOATS + side * VCT_SIDE_FLOATS;
	for (uint i = 0u; i < 3u; i++)
		vct_total[at + i] = uintBitsToFloat(vct_direct[at + i]) + e[i];
	if (trace_cut)
		atomicAdd(vct_direct[vct_direct.length() - 1], 1u);
}
