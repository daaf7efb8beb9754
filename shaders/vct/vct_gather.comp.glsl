// The bounce from surface to surface: traces the diffuse cones of both sides of every entry and adds the result to the
// light from the lights.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "common/pi.glsl"
#include "vct/cone.glsl"
#include "vct/entry.glsl"
#include "voxel/lookup.glsl"

layout(local_size_x = VCT_GROUP) in;
layout(location = VCT_RANGE) uniform uvec2 range;

layout(std430, binding = BIND_VCT_DIRECT) readonly buffer VctDirect {
	float vct_direct[];
};
layout(std430, binding = BIND_VCT_TOTAL) writeonly buffer VctTotal {
	float vct_total[];
};

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
	cone_origin o = cone_from(uintBitsToFloat(place.xyz), normal, 0.0);
	vec3 e = vec3(0.0);
	uint group = entry_group(entry_voxel(voxel_albedo[entry].w >> 1, vct_sides_top.xyz * 2u));
	for (uint i = group; i < VCT_GATHER_CONES; i += VCT_GATHER_GROUPS) {
		vec4 c = vct_gather[i];
		e += cone_radiance(o, c.x * x + c.y * y + c.z * normal, c.w);
	}
	e *= PI * float(VCT_GATHER_GROUPS) / float(VCT_GATHER_CONES);
	uint at = entry * VCT_ENTRY_FLOATS + side * VCT_SIDE_FLOATS;
	for (uint i = 0u; i < 3u; i++)
		vct_total[at + i] = vct_direct[at + i] + e[i];
}
