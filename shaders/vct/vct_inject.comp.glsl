// Builds the pyramid's finest level from the entries. One invocation for each occupied cell and axis.
//
// In each direction along the axis there are four columns of two voxels. The nearer voxel counts first, the farther one
// with what the nearer leaves open. Sides that face the viewing direction come before sides that turn their back to it,
// because the far side of a solid is behind its near side.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "common/pi.glsl"
#include "vct/cells.glsl"
#include "vct/pair.glsl"

#ifndef VCT_ISOTROPIC
#define VCT_ISOTROPIC false
#endif
#ifndef VCT_REFLECTS
#define VCT_REFLECTS true     // else surfaces reflect none of the light on them: no bounce
#endif
#ifndef VCT_SHARES
#define VCT_SHARES false     // store shares in place of radiance
#endif

layout(local_size_x = VCT_GROUP) in;
layout(location = VCT_RANGE) uniform uvec2 range;
layout(binding = VCT_PYRAMID_IMAGE, rgba16f) uniform writeonly image3D level_image;

layout(std430, binding = BIND_VCT_CELLS) readonly buffer VctCells {
	uint vct_cells[];
};
layout(std430, binding = BIND_VCT_TOTAL) readonly buffer VctTotal {
	float vct_total[];
};

// Coverage (a) and coverage × radiance (scaled, rgb) of a voxel in both directions along an axis.
struct ways {
	vec4 up;     // for a cone that looks along +axis
	vec4 down;
};

vec3 side_radiance(uint entry, uint side)
{
	uint i = entry * VCT_ENTRY_FLOATS + side * VCT_SIDE_FLOATS;
	if (VCT_SHARES)
		return vec3(vct_total[i + 3u]);
	if (!VCT_REFLECTS)
		return vec3(0.0);
	vec3 r = voxel_diffuse_albedo(entry) * vec3(vct_total[i], vct_total[i + 1u], vct_total[i + 2u]) * (1.0 / PI);
	return r * vct_background_scale.w;
}

// Limits a coverage to `room`.
vec4 within(vec4 c, float room)
{
	return c.a > room ? c * (room / c.a) : c;
}

// Coverage along the axis that an entry faces most.
float widest_face(uint entry)
{
	uvec4 c = voxel_coverage[entry];
	vec3 faces = vec3(dot(unpackHalf2x16(c.x), vec2(1.0)), dot(unpackHalf2x16(c.y), vec2(1.0)), dot(unpackHalf2x16(c.z), vec2(1.0)));
	return max(faces.x, max(faces.y, faces.z));
}

ways voxel_ways(uvec3 voxel, uint axis)
{
	ways front = ways(vec4(0.0), vec4(0.0));
	ways back = front;
	uint layers = voxel_layers(voxel);
	for (uint layer = 0u; layer < 2u; layer++) {
		if ((layers >> layer & 1u) == 0u)
			continue;
		uint entry = voxel_entry(voxel, layer);
		vec2 faces = unpackHalf2x16(voxel_coverage[entry][axis]);   // coverage of surfaces that face +axis, −axis
		vec3 ahead = side_radiance(entry, 0u);
		vec3 behind = side_radiance(entry, 1u);
		if (vct_cones_emission.y != 0u && !VCT_SHARES) {
			vec3 emitted = voxel_emitted(entry) * vct_background_scale.w;
			ahead += emitted;
			behind += voxel_emits_back(entry) ? emitted : vec3(0.0);
		}
		// A cone that looks down sees surfaces that face up.
		front.up += faces.y * vec4(ahead, 1.0);
		front.down += faces.x * vec4(ahead, 1.0);
		// An oblique wall turns its back, along some axis, to a viewer in front of it. So backs count only along
		// the axis that they face most: there, only a viewer who looks along the wall confuses the two.
		if (faces.x + faces.y < widest_face(entry))
			continue;
		back.up += faces.x * vec4(behind, 1.0);
		back.down += faces.y * vec4(behind, 1.0);
	}
	front.up = within(front.up, 1.0);
	front.down = within(front.down, 1.0);
	front.up += within(back.up, 1.0 - front.up.a);
	front.down += within(back.down, 1.0 - front.down.a);
	return front;
}

// Both directions through a cell: four columns.
ways cell_ways(uvec3 cell, uint axis)
{
	vec4 up = vec4(0.0);
	vec4 down = vec4(0.0);
	for (uint column = 0u; column < 4u; column++) {
		uint first = axis == 0u ? column << 1 : axis == 1u ? (column & 1u) | (column & 2u) << 1 : column;
		ways low = voxel_ways(child_voxel(cell, first), axis);
		ways high = voxel_ways(child_voxel(cell, first | 1u << axis), axis);
		up += 0.25 * pair(low.up, high.up);
		down += 0.25 * pair(high.down, low.down);
	}
	return ways(up, down);
}

// One value for all directions: the largest coverage and the mean radiance.
vec4 isotropic(uvec3 cell)
{
	vec4 sum = vec4(0.0);
	float most = 0.0;
	for (uint axis = 0u; axis < 3u; axis++) {
		ways w = cell_ways(cell, axis);
		sum += w.up + w.down;
		most = max(most, max(w.up.a, w.down.a));
	}
	return sum.a > 0.0 ? sum * (most / sum.a) : vec4(0.0);
}

void main()
{
	uint item = range.x + gl_GlobalInvocationID.x;
	if (gl_GlobalInvocationID.x >= range.y)
		return;
	uint axis = item % 3u;
	uvec3 cell = cell_of(vct_cells[1u + item / 3u]);
	uint wide = vct_sides_top.x;
	if (VCT_ISOTROPIC && !VCT_SHARES) {
		// There is one invocation for each cell and axis here too; that of the first axis does the work.
		if (axis == 0u)
			imageStore(level_image, ivec3(cell), isotropic(cell));
		return;
	}
	ways w = cell_ways(cell, axis);
	imageStore(level_image, ivec3(cell.x + 2u * axis * wide, cell.yz), w.up);
	imageStore(level_image, ivec3(cell.x + (2u * axis + 1u) * wide, cell.yz), w.down);
}
