// Which parts of patches lie inside of other bodies: beneath a block, say, that stands on a floor. No light gets there, so that
// they are no part of what a patch receives, nor of what it is seen by.
//
// A dispatch looks at one part of each patch, an invocation a patch: PATCH_COVER_RAYS rays go by the cosine from its middle, on the
// patch's front. It is inside of a body if all of them meet backs. Where half of them do, that is kept too: in a room whose walls
// show their backs to furniture, parts that see walls alone are inside of nothing, as others of the patch tell (covers_part).
//
// What is found depends on places and masks alone, and bits are only ever added. So a pass may be repeated at any time.
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

// How many of the rays from a point meet backs. It is cut short where they cannot be half of them any more.
uint backs_met(uint i, patch_point at, bool mine)
{
	corners k = corners_of(triangles[at.id]);
	vec3 p = point_inside(k, at.uv, position_error(k));
	vec3 origin = p + start_offset(k, p) * k.normal;
	vec3 x, y;
	frame_make(k.normal, x, y);
	uint ray = 0u, backs = 0u, others = mine ? 0u : PATCH_COVER_RAYS;
	bool more = true;
	do {
		ray_hit hit;
		bool open = 2u * others > PATCH_COVER_RAYS;
		sampler_state random = sampler_make(i, 0u, ray, push.point, 0u);
		vec3 l = cosine_hemisphere(sample_2d(random, SET_BSDF));
		vec3 w = l.x * x + l.y * y + l.z * k.normal;
		bool met = trace_closest(origin, w, open ? -1.0 : INFINITY, hit);
		bool back = met && !open && dot(corners_of(triangles[hit.id]).normal, w) >= 0.0;
		backs += back ? 1u : 0u;
		others += back ? 0u : 1u;
		ray++;
		trace_rounds++;
		more = subgroupAny(2u * others <= PATCH_COVER_RAYS);
	} while (more && ray < PATCH_COVER_RAYS);
	return backs;
}

void main()
{
	bool mine = gl_GlobalInvocationID.x < push.count;
	uint i = push.first + (mine ? gl_GlobalInvocationID.x : 0u);
	uint backs = backs_met(i, patch_point_at(i, radiosity_patches[i].face, cover_middle(push.point)), mine);
	if (!mine)
		return;
	uint inside = backs == PATCH_COVER_RAYS ? 1u : 0u;
	uint doubtful = 2u * backs >= PATCH_COVER_RAYS ? 1u : 0u;
	radiosity_patches[i].covered |= (inside | doubtful << PATCH_COVER_PARTS) << push.point;
	if (trace_cut)
		atomicAdd(counters.cut, 1u);
}
