// Builds a level of the pyramid from the one below. One invocation for each cell and direction.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "vct/pair.glsl"
#include "vct/params.glsl"

#ifndef VCT_ISOTROPIC
#define VCT_ISOTROPIC false
#endif

layout(local_size_x = VCT_GROUP) in;
layout(location = VCT_RANGE) uniform uvec2 range;
layout(location = VCT_LEVEL) uniform uint level;   // the level being built
layout(binding = VCT_PYRAMID_UNIT) uniform sampler3D vct_pyramid;
layout(binding = VCT_PYRAMID_IMAGE, rgba16f) uniform writeonly image3D level_image;

vec4 below(uvec3 at, uint way, uint side)
{
	return texelFetch(vct_pyramid, ivec3(at.x + way * side, at.yz), int(level) - 1);
}

// The combined value along one axis, in one direction.
vec4 along_axis(uvec3 first, uint axis, bool up, uint way, uint side)
{
	uvec3 along = uvec3(axis == 0u, axis == 1u, axis == 2u);
	uvec3 across = along.zxy;
	uvec3 over = along.yzx;
	vec4 sum = vec4(0.0);
	for (uint k = 0u; k < 4u; k++) {
		uvec3 at = first + across * (k & 1u) + over * (k >> 1);
		vec4 low = below(at, way, side);
		vec4 high = below(at + along, way, side);
		sum += 0.25 * (up ? pair(low, high) : pair(high, low));
	}
	return sum;
}

void main()
{
	uint index = range.x + gl_GlobalInvocationID.x;
	if (gl_GlobalInvocationID.x >= range.y)
		return;
	uvec3 sides = vct_sides_top.xyz >> level;
	uint wide = (VCT_ISOTROPIC ? 1u : 6u) * sides.x;
	uvec3 cell = uvec3(index % wide, index / wide % sides.y, index / wide / sides.y);
	uint way = cell.x / sides.x;
	uint side = sides.x * 2u;   // of the level below
	uvec3 first = 2u * uvec3(cell.x % sides.x, cell.yz);
	vec4 sum;
	if (VCT_ISOTROPIC)
		sum = (along_axis(first, 0u, true, 0u, side) + along_axis(first, 1u, true, 0u, side) +
		       along_axis(first, 2u, true, 0u, side)) * (1.0 / 3.0);
	else
		sum = along_axis(first, way / 2u, (way & 1u) == 0u, way, side);
	imageStore(level_image, ivec3(cell), sum);
}
