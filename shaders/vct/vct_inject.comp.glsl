// The pyramid's finest level out of the entries: one invocation a cell of two by two by two voxels.
//
// Along each way, four columns of two voxels: the nearer first, of the farther what the nearer leaves open. Sides that face the
// way come before sides that turn their back to it, for a solid's far side is behind its near side.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "vct/params.glsl"
#include "voxel/lookup.glsl"

layout(local_size_x = VCT_GROUP) in;
layout(location = VCT_RANGE) uniform uvec2 range;
layout(binding = VCT_PYRAMID_IMAGE, rgba16f) uniform writeonly image3D level_image;

layout(std430, binding = BIND_VCT_TOTAL) readonly buffer VctTotal {
	float vct_total[];
};

const float PI = 3.14159265358979323846;

// Coverage (w) and coverage × radiance (scaled) of a voxel, one way each: +x, −x, +y, −y, +z, −z.
struct ways {
	vec4 way[6];
};

vec3 side_radiance(uint entry, uint side)
{
	uint i = entry * 6u + side * 3u;
	vec3 r = voxel_diffuse_albedo(entry) * vec3(vct_total[i], vct_total[i + 1u], vct_total[i + 2u]) * (1.0 / PI);
	return r * vct_background_scale.w;
}

void add_entry(inout ways front, inout ways back, uint entry)
{
	vec3 plus, minus;
	voxel_projections(entry, plus, minus);
	vec3 ahead = side_radiance(entry, 0u);
	vec3 behind = side_radiance(entry, 1u);
	if (vct_reach_emission.y != 0u)
		ahead += voxel_emitted(entry) * vct_background_scale.w;
	for (uint i = 0u; i < 3u; i++) {
		// Looked for along +axis, light comes from what faces −axis.
		front.way[2u * i] += minus[i] * vec4(ahead, 1.0);
		front.way[2u * i + 1u] += plus[i] * vec4(ahead, 1.0);
		back.way[2u * i] += plus[i] * vec4(behind, 1.0);
		back.way[2u * i + 1u] += minus[i] * vec4(behind, 1.0);
	}
}

// No more than `room` of a coverage.
vec4 within(vec4 c, float room)
{
	return c.a > room ? c * (room / c.a) : c;
}

ways voxel_ways(uvec3 cell)
{
	ways front, back;
	for (uint i = 0u; i < 6u; i++) {
		front.way[i] = vec4(0.0);
		back.way[i] = vec4(0.0);
	}
	for (uint layer = 0u; layer < 2u; layer++) {
		uint entry = voxel_entry(cell, layer);
		if (entry != NONE)
			add_entry(front, back, entry);
	}
	for (uint i = 0u; i < 6u; i++) {
		front.way[i] = within(front.way[i], 1.0);
		front.way[i] += within(back.way[i], 1.0 - front.way[i].a);
	}
	return front;
}

// The nearer and what it leaves of the farther: between the two hiding the same part of the face and hiding parts side by side.
vec4 pair(vec4 near, vec4 far)
{
	float apart = min(far.a, 1.0 - near.a);
	float alike = max(far.a - near.a, 0.0);
	float rest = 0.5 * (apart + alike);
	return near + (far.a > 0.0 ? far * (rest / far.a) : vec4(0.0));
}

void main()
{
	uint index = range.x + gl_GlobalInvocationID.x;
	if (gl_GlobalInvocationID.x >= range.y)
		return;
	uvec3 sides = vct_sides_top.xyz;
	uvec3 cell = uvec3(index % sides.x, index / sides.x % sides.y, index / sides.x / sides.y);
	vec4 sum[6];
	for (uint i = 0u; i < 6u; i++)
		sum[i] = vec4(0.0);
	bool any = false;
	for (uint k = 0u; k < 8u; k++)
		any = any || voxel_layers(min(2u * cell + uvec3(k & 1u, k >> 1 & 1u, k >> 2), voxel_sides() - 1u)) != 0u;
	if (any) {
		ways child[8];
		for (uint k = 0u; k < 8u; k++)
			child[k] = voxel_ways(min(2u * cell + uvec3(k & 1u, k >> 1 & 1u, k >> 2), voxel_sides() - 1u));
		for (uint axis = 0u; axis < 3u; axis++)
			for (uint column = 0u; column < 4u; column++) {
				uint along = 1u << axis;
				uint a = axis == 0u ? column << 1 : axis == 1u ? (column & 1u) | (column & 2u) << 1 : column;
				sum[2u * axis] += 0.25 * pair(child[a].way[2u * axis], child[a | along].way[2u * axis]);
				sum[2u * axis + 1u] += 0.25 * pair(child[a | along].way[2u * axis + 1u], child[a].way[2u * axis + 1u]);
			}
	}
	for (uint i = 0u; i < 6u; i++)
		imageStore(level_image, ivec3(cell.x + i * sides.x, cell.yz), sum[i]);
}
