// Direct irradiance, with shadows, of both sides of every entry.
#version 450 core
#extension GL_GOOGLE_include_directive : require
#define SCENE_WITHOUT_TANGENTS
#define SCENE_WITHOUT_GGX

#include "shared/bindings.h"

// These replace two storage blocks, whose places the voxels need. Neither is read, because an entry has no microfacets and
// no normal maps.
vertex_tangent tangents[1];
vec2 ggx_table[1];

#include "vct/entry.glsl"
#if defined(VCT_SHADOW_HARD) && !defined(VCT_SHADOW_VOLUME)
#include "vct/shadow.glsl"
#endif
// Each entry has its own set of points. One set for all would miss the same parts of the lamps everywhere, and a cone reads
// many entries together.
uint entry_turn;
#define DIRECT_TURN entry_turn
// The ratio to the closed form is biased for the few points of one entry, most where a lamp is seen through a gap. The
// points alone are unbiased, and a cone's mean over many entries shows little of their noise.
#undef DIRECT_CLOSED
#define DIRECT_CLOSED false
#undef DIRECT_SHARP
#define DIRECT_SHARP false
#include "direct/lighting.glsl"
#include "shared/vct.h"
#include "shared/voxel.h"
#include "voxel/octahedral.glsl"

#ifndef VCT_WEIGHTED
#define VCT_WEIGHTED false
#endif

layout(local_size_x = VCT_GROUP) in;
layout(location = VCT_RANGE) uniform uvec2 range;
layout(location = VCT_LEVEL) uniform float voxel_size;   // metres

layout(std430, binding = BIND_VOXEL_PLACE) readonly buffer VoxelPlace {
	uvec4 voxel_place[];
};
layout(std430, binding = BIND_VCT_DIRECT) buffer VctDirect {
	uint vct_direct[];
};

// Without VCT_WEIGHTED: Lambert's irradiance about the mean normal. With it: the irradiances about the three axes on the
// normal's side, weighted by the squares of its components, for voxels whose surfaces face many ways, so that the mean
// normal says little.
vec3 entry_irradiance(vec3 position, vec3 n, uint pattern)
{
	float off = 0.25 * voxel_size;
	if (!VCT_WEIGHTED)
		return direct_irradiance(position, n, off, pattern);
	vec3 sum = vec3(0.0);
	for (uint i = 0u; i < 3u; i++) {
		vec3 axis = vec3(i == 0u, i == 1u, i == 2u) * (n[i] < 0.0 ? -1.0 : 1.0);
		if (n[i] != 0.0)
			sum += n[i] * n[i] * direct_irradiance(position, axis, off, pattern + i);
	}
	return sum;
}

void main()
{
	uint entry = range.x + gl_GlobalInvocationID.x;
	if (gl_GlobalInvocationID.x >= range.y)
		return;
	uvec4 place = voxel_place[entry];
	vec3 position = uintBitsToFloat(place.xyz);
	vec3 normal = octahedral_unpack(place.w);
	vec3 most = vec3(0.0);
	entry_turn = hash(entry) & 255u;
	for (uint side = 0u; side < 2u; side++) {
		// The point is moved off the surface by a part of the voxel's size: the mean position of a curved surface
		// lies slightly inside of it.
		direct_share = vec2(0.0);
		vec3 e = entry_bounded(entry_irradiance(position, side == 0u ? normal : -normal, entry * 7u + side));
		for (uint i = 0u; i < 3u; i++)
			vct_direct[entry * VCT_ENTRY_FLOATS + side * VCT_SIDE_FLOATS + i] = floatBitsToUint(e[i]);
		// Where no light shines there is nothing to shade: the share is 1.
		float share = direct_share.y > 0.0 ? clamp(direct_share.x / direct_share.y, 0.0, 1.0) : 1.0;
		vct_direct[entry * VCT_ENTRY_FLOATS + side * VCT_SIDE_FLOATS + 3u] = floatBitsToUint(share);
		most = max(most, e);
	}
	atomicMax(vct_direct[vct_direct.length() - 2], floatBitsToUint(max(most.r, max(most.g, most.b))));
	if (trace_cut)
		atomicAdd(vct_direct[vct_direct.length() - 1], 1u);
}
