// Rows of form factors by rays: a row of workgroups traces the rays of one element and counts their weights at the elements
// that they meet. The sums are of integers, so the order of the rays does not change them.
//
// At a mirror the weight is counted for the mirror's own element, and what the mirror reflects of it goes on in the mirror's
// direction: extended form factors (Sillion and Puech 1989).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_KHR_shader_subgroup_vote : require

#include "trace/traverse.glsl"
#include "shared/factor_rays.h"

layout(local_size_x = FACTOR_LANES) in;

layout(push_constant) uniform Push {
	factor_push push;
};
layout(std430, set = 0, binding = BIND_COUNTERS) buffer Counters {
	pass_counters counters;
};
layout(std430, set = 0, binding = BIND_RADIOSITY_FACES) readonly buffer Faces {
	radiosity_face radiosity_faces[];
};
layout(std430, set = 0, binding = BIND_RADIOSITY_TRIANGLES) readonly buffer FaceTriangles {
	uint radiosity_triangles[];
};
layout(std430, set = 0, binding = BIND_RADIOSITY_PATCHES) readonly buffer Patches {
	radiosity_patch radiosity_patches[];
};
layout(std430, set = 0, binding = BIND_RADIOSITY_SURFACES) readonly buffer Surfaces {
	radiosity_surface radiosity_surfaces[];
};
layout(std430, set = 0, binding = BIND_FACTOR_TABLE) readonly buffer Table {
	uvec4 factor_table[];
};
layout(std430, set = 0, binding = BIND_FACTOR_ROWS) readonly buffer Rows {
	uint factor_rows[];
};
layout(std430, set = 0, binding = BIND_FACTOR_DENSE) buffer Dense {
	uint factor_dense[];
};
layout(std430, set = 0, binding = BIND_FACTOR_SUMS) buffer Sums {
	factor_sums sums[];
};
layout(std430, set = 0, binding = BIND_FACTOR_SECONDS) readonly buffer Seconds {
	uint factor_seconds[];
};

layout(constant_id = SPEC_FACTOR_MIRRORS) const bool MIRRORS = false;

#define PATCH_COUNT push.patches
#include "radiosity/element.glsl"
#include "radiosity/factor_source.glsl"

// A ray on its way.
struct walker {
	vec3 origin;
	vec3 direction;
	uint weight;
	bool alive;
};

// What a mirror lets go on of a weight: by its luminance (Rec. ITU-R BT.709), for all channels share the factors.
uint mirrored(uint element, uint weight)
{
	float m = dot(to_vec3(radiosity_surfaces[element].mirror), vec3(0.2126, 0.7152, 0.0722));
	return uint(float(weight) * clamp(m, 0.0, 1.0) + 0.5);
}

void reflect_at(inout walker w, corners c, ray_hit hit)
{
	vec3 p = point_met(c, hit.uv, w.origin, w.direction, hit.t);
	vec3 n = dot(c.normal, w.direction) < 0.0 ? c.normal : -c.normal;
	w.origin = p + start_offset(c, p) * n;
	w.direction = normalize(reflect(w.direction, n));
}

// Counts a hit. The ray goes on only at a mirror.
void arrive(inout walker w, uint row, ray_hit hit, uint bounce, inout factor_sums lost)
{
	corners c = corners_of(triangles[hit.id]);
	uint element = element_at(hit.id, hit.uv, dot(c.normal, w.direction) < 0.0);
	w.alive = false;
	if (element == NONE) {
		lost.cut += w.weight;
		return;
	}
	atomicAdd(factor_dense[row * 2u * push.patches + element], w.weight);
	if (!MIRRORS)
		return;
	w.weight = mirrored(element, w.weight);
	if (bounce == push.bounces)
		lost.cut += w.weight;
	else if (w.weight > 0u) {
		w.alive = true;
		reflect_at(w, c, hit);
	}
}

void trace_ray(inout walker w, uint row, uint bounce, inout factor_sums lost)
{
	ray_hit hit;
	bool found = trace_closest(w.origin, w.direction, w.alive ? INFINITY : -1.0, hit);
	if (w.alive && found) {
		arrive(w, row, hit, bounce, lost);
	} else if (w.alive) {
		lost.escaped += w.weight;
		w.alive = false;
	}
}

void main()
{
	uint row = push.first_row + gl_WorkGroupID.y;
	uint element = factor_rows[row];
	factor_source s = source_make(element, push.patches);
	uint first = gl_WorkGroupID.x * push.per_lane * FACTOR_LANES;
	factor_sums lost = factor_sums(0u, 0u);
	uint traced = 0u;
	do {
		uint i = first + traced * FACTOR_LANES + gl_LocalInvocationIndex;
		walker w;
		w.weight = push.weight;
		w.alive = i < push.rays;
		source_ray(s, min(i, max(push.rays, 1u) - 1u), w.origin, w.direction);
		if (EFFECT_ALPHA_BLEND) {
			trace_chance = hash(element) | 1u;
			trace_index = i;
		}
		trace_ray(w, row, 0u, lost);
		if (MIRRORS) {
			uint bounce = 1u;
			bool more = subgroupAny(w.alive);
			if (more) do {
				trace_ray(w, row, bounce, lost);
				bounce++;
				trace_rounds++;
				more = subgroupAny(w.alive);
			} while (more);
			trace_cut = trace_cut || w.alive;
		}
		traced++;
		trace_rounds++;
	} while (traced < push.per_lane);
	if (lost.escaped > 0u)
		atomicAdd(sums[row].escaped, lost.escaped);
	if (lost.cut > 0u)
		atomicAdd(sums[row].cut, lost.cut);
	if (trace_cut || traced < push.per_lane)
		atomicAdd(counters.cut, 1u);
	atomicMax(counters.loop_rounds, trace_rounds);
}
