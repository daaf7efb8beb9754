// Traces the rays of one buffer and writes the hits to another: the traversal by itself, for tests and measurements.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require

#include "trace/traverse.glsl"
#include "shared/cast.h"

layout(local_size_x = 64) in;

layout(push_constant) uniform Push {
	uint first;
	uint count;      // > 0
	uint any;        // 1: any hit ends the ray, not only the closest
} push;
layout(std430, set = 0, binding = BIND_RAYS) readonly buffer Rays {
	cast_ray rays[];
};
layout(std430, set = 0, binding = BIND_HITS) writeonly buffer Hits {
	cast_hit hits[];
};

void main()
{
	bool mine = gl_GlobalInvocationID.x < push.count;
	uint i = push.first + min(gl_GlobalInvocationID.x, push.count - 1u);
	cast_ray ray = rays[i];
	ray_hit hit;
	if (push.any != 0u) {
		hit.id = trace_any(to_vec3(ray.origin), to_vec3(ray.direction), mine ? ray.t_max : -1.0) ? 0u : NONE;
		hit.t = 0.0;
		hit.uv = vec2(0.0);
	} else {
		trace_closest(to_vec3(ray.origin), to_vec3(ray.direction), mine ? ray.t_max : -1.0, hit);
	}
	if (mine)
		hits[i] = cast_hit(hit.t, trace_cut ? NONE - 1u : hit.id, hit.uv.x, hit.uv.y);
}
