// The AOVs of the ray through a pixel's middle: depth, normal, albedo, id. The pass runs once, and only if the request
// names an AOV.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require

#include "common/surface.glsl"
#include "common/tile.glsl"
#include "pt/lens.glsl"
#include "trace/traverse.glsl"
#include "shared/pt.h"

layout(local_size_x = TILE_PIXELS) in;

layout(push_constant) uniform Push {
	path_push push;
};
layout(std430, set = 0, binding = BIND_AOV) writeonly buffer Aov {
	uint aov[];
};

void main()
{
	uvec2 pixel = tile_pixel(push.first_tile + gl_WorkGroupID.x, job.tiles_x);
	bool mine = pixel.x < job.width && pixel.y < job.height;
	vec3 origin, direction;
	// The ray goes through the middle of the lens.
	lens_ray(vec2(pixel) + 0.5, vec2(0.5), origin, direction);
	ray_hit hit;
	float depth = INFINITY;
	vec3 normal = vec3(0.0);
	vec3 albedo = vec3(0.0);
	uint id = 0u;
	bool found = trace_closest(origin, direction, mine ? INFINITY : -1.0, hit);
	if (!mine)
		return;
	if (found) {
		surface s = surface_at(hit.id, hit.uv, origin, direction, hit.t);
		depth = CAMERA == CAMERA_PANORAMA ? hit.t : hit.t * dot(direction, to_vec3(job.forward));
		normal = s.shading;
		albedo = s.base;
		id = hit.material + 1u;
	}
	uint at = ((pixel.y - push.first_row) * job.width + pixel.x) * AOV_WORDS;
	aov[at] = floatBitsToUint(depth);
	for (uint i = 0u; i < 3u; i++) {
		aov[at + 1u + i] = floatBitsToUint(normal[i]);
		aov[at + 4u + i] = floatBitsToUint(albedo[i]);
	}
	aov[at + 7u] = id;
}
