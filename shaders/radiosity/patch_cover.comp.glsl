// Which parts of patches lie inside of other bodies: beneath a block, say, that stands on a floor. No light gets there, so that
// they are no part of what a patch receives, nor of what it is seen by.
//
// A dispatch looks at one part of each patch, an invocation a patch: PATCH_COVER_RAYS rays go by the cosine from its middle, on the
// patch's front. It is inside of a body if all of them meet backs. In a room whose walls show their backs there are no such
// fronts, or the whole patch is such a part, which then counts for nothing (covers_part).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_vote : require
#extension GL_KHR_shader_subgroup_shuffle : require

#define PATCHES_WRITTEN
#include "common/surface.glsl"
#include "trace/traverse.glsl"
#include "shared/patch_pass.h"

layout(constant_id = SPEC_PATCH_COUNT) const uint PATCH_COUNT = 0u;

layout(local_size_x = PATCH_GROUP) in;

layout(push_constant) uniform Push {
	patch_push push;
};
layout(std430, set = 0, binding = BIND_COUNTERS) buffer Counters {
	pass_counters counters;
};
#include "radiosity/patch_point.glsl"

// Whether all rays from a point meet backs.
bool is_inside(uint i, patch_point at, bool mine)
{
	corners k = corners_of(triangles[at.id]);
	vec3 p = point_inside(k, at.uv, position_error(k));
	vec3 origin = p + start_offset(k, p) * k.normal;
	vec3 x, y;
	frame_make(k.normal, x, y);
	bool open = !mine;
	uint ray = 0u;
	bool more = true;
	do {
		ray_hit hit;
		sampler_state random = sampler_make(i, 0u, ray, push.point, 0u);
		vec3 l = cosine_hemisphere(sample_2d(random, SET_BSDF));
		vec3 w = l.x * x + l.y * y + l.z * k.normal;
		bool met = trace_closest(origin, w, open ? -1.0 : INFINITY, hit);
		if (!open)
			open = !met || dot(corners_of(triangles[hit.id]).normal, w) < 0.0;
		ray++;
		trace_rounds++;
		more = subgroupAny(!open);
	} while (more && ray < PATCH_COVER_RAYS);
	return !open;
}

void main()
{
	bool mine = gl_GlobalInvocationID.x < push.count;
	uint i = push.first + (mine ? gl_GlobalInvocationID.x : 0u);
	bool inside = is_inside(i, patch_point_at(i, radiosity_patches[i].face, cover_middle(push.point)), mine);
	if (!mine)
		return;
	uint covered = push.point == 0u ? 0u : radiosity_patches[i].covered;
	radiosity_patches[i].covered = covered | (inside ? 1u << push.point : 0u);
	if (trace_cut)
		atomicAdd(counters.cut, 1u);
}
