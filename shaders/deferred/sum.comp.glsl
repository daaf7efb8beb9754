// The last pass of a sample: adds it to the sums, and notes which pixels see a surface. Values that are not finite are counted
// and left out.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "common/finite.glsl"
#include "deferred/radiance.glsl"
#include "common/accumulate.glsl"
#include "shared/scene_params.h"

layout(local_size_x = TILE_PIXELS) in;

layout(std430, binding = BIND_COUNTERS) buffer Counters {
	pass_counters counters;
	uint met[];
};
#include "common/met.glsl"
layout(binding = DEFERRED_VISIBILITY_UNIT) uniform usampler2D visibility;

void main()
{
	uvec2 pixel;
	if (!pixel_mine(pixel))
		return;
	ivec2 texel = pixel_texel(pixel);
	vec4 value = imageLoad(radiance_image, texel);
	imageStore(radiance_image, texel, vec4(0.0));
	if (texelFetch(visibility, texel, 0).x != 0u)
		met_note(area.z + gl_WorkGroupID.x, gl_LocalInvocationIndex);
	uint rays = uint(abs(value.w));
	if (rays > 0u) {
		uint before = atomicAdd(counters.rays, rays);
		if (before + rays < before)
			atomicAdd(counters.rays_high, 1u);
	}
	if (value.w < 0.0)
		atomicAdd(counters.cut, 1u);
	if (!finite(value.rgb)) {
		atomicAdd(counters.non_finite, 1u);
		value.rgb = vec3(0.0);
	}
	uint at = (uint(texel.y) * turn.w + uint(texel.x)) * (ACCUMULATOR_FLOATS / 2) + turn.x * 3u;
	for (uint i = 0u; i < 3u; i++)
		accumulator[at + i] = add_compensated(accumulator[at + i], value[i]);
}
