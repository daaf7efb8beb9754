// Light from surface to surface: the diffuse cones of both sides of every entry, added to what comes from the lights.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "vct/cone.glsl"
#include "voxel/octahedral.glsl"
#include "shared/voxel.h"

layout(local_size_x = VCT_GROUP) in;
layout(location = VCT_RANGE) uniform uvec2 range;

layout(std430, binding = BIND_VOXEL_PLACE) readonly buffer VoxelPlace {
	uvec4 voxel_place[];
};
layout(std430, binding = BIND_VCT_DIRECT) readonly buffer VctDirect {
	float vct_direct[];
};
layout(std430, binding = BIND_VCT_TOTAL) writeonly buffer VctTotal {
	float vct_total[];
};

const float PI = 3.14159265358979323846;

void frame_of(vec3 n, out vec3 x, out vec3 y)
{
	// Duff et al. 2017, "Building an orthonormal basis, revisited".
	float s = n.z >= 0.0 ? 1.0 : -1.0;
	float a = -1.0 / (s + n.z);
	float b = n.x * n.y * a;
	x = vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x);
	y = vec3(b, s + n.y * n.y * a, -n.y);
}

void main()
{
	uint item = range.x + gl_GlobalInvocationID.x;
	if (gl_GlobalInvocationID.x >= range.y)
		return;
	uint entry = item >> 1;
	uint side = item & 1u;
	uvec4 place = voxel_place[entry];
	vec3 normal = octahedral_unpack(place.w);
	normal = side == 0u ? normal : -normal;
	vec3 x, y;
	frame_of(normal, x, y);
	vec3 e = PI * cone_irradiance(cone_from(uintBitsToFloat(place.xyz), normal, 0.0), x, y, normal);
	uint at = entry * 6u + side * 3u;
	for (uint i = 0u; i < 3u; i++)
		vct_total[at + i] = vct_direct[at + i] + e[i];
}
