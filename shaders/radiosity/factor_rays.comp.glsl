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

#define TRACE_BUNDLES
#include "trace/traverse.glsl"
#include "shared/factor_rays.h"

layout(local_size_x = FACTOR_LANES) in;

layout(push_constant) uniform Push {
	factor_push push;
};
layout(std430, set = 0, binding = BIND_COUNTERS) buffer Counters {
	pass_counters counters;
};
layout(set = 0, binding = BIND_FACTOR_TRIANGLES) uniform utextureBuffer factor_triangles;
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

#define RADIOSITY_PLACES_ONLY
#include "radiosity/element.glsl"
#include "radiosity/factor_source.glsl"

// A ray on its way.
struct walker {
	vec3 origin;
	vec3 direction;
	uint weight;
	bool alive;
};

// The element that a ray met; NONE: a triangle without an area.
uint element_met(ray_hit hit, vec3 direction)
{
	uvec4 a = texelFetch(factor_triangles, int(2u * hit.id));
	uvec4 b = texelFetch(factor_triangles, int(2u * hit.id + 1u));
	radiosity_face f = radiosity_face(a.w, b.x & ((1u << FACTOR_WORD_SHIFT) - 1u), b.y, uintBitsToFloat(b.z),
					  uintBitsToFloat(b.w));
	vec2 inside;
	uint i = patch_at(f, face_place(b.x >> FACTOR_WORD_SHIFT, f, hit.uv), inside);
	i += dot(uintBitsToFloat(a.xyz), direction) < 0.0 ? 0u : push.patches;
	return a.w == NONE ? NONE : i;
}

// What a mirror lets go on of a weight: by its luminance (Rec. ITU-R BT.709), for all channels share the factors.
uint mirrored(uint element, uint weight)
{
	float m = dot(to_vec3(radiosity_surfaces[element].mirror), vec3(0.2126, 0.7152, 0.0722));
	return uint(float(weight) * clamp(m, 0.0, 1.0) + 0.5);
}

void reflect_at(inout walker w, ray_hit hit)
{
	corners c = corners_of(triangles[hit.id]);
	vec3 p = point_met(c, hit.uv, w.origin, w.direction, hit.t);
	vec3 n = dot(c.normal, w.direction) < 0.0 ? c.normal : -c.normal;
	w.origin = p + start_offset(c, p) * n;
	w.direction = normalize(reflect(w.direction, n));
}

// Counts where a ray arrived. It goes on only at a mirror.
void arrive(inout walker w, uint row, ray_hit hit, uint bounce, inout factor_sums lost)
{
	if (!w.alive)
		return;
	w.alive = false;
	if (hit.id == NONE) {
		lost.escaped += w.weight;
		return;
	}
	uint element = element_met(hit, w.direction);
	if (element == NONE) {
		lost.cut += w.weight;
		return;
	}
	atomicAdd(factor_dense[row * 2u * push.patches + element], w.weight);
	if (!MIRRORS)
		return;
	w.weight = mirrored(element, w.weight);
	w.alive = w.weight > 0u && bounce < push.bounces;
	if (w.alive)
		reflect_at(w, hit);
	else
		lost.cut += w.weight;
}

walker start(factor_source s, uint i)
{
	walker w;
	w.weight = push.weight;
	w.alive = i < push.rays;
	source_ray(s, min(i, max(push.rays, 1u) - 1u), w.origin, w.direction);
	return w;
}

// Follow a ray to its end.
void follow(factor_source s, uint row, uint chance, uint i, inout factor_sums lost)
{
	walker w = start(s, i);
	uint bounce = 0u;
	bool more;
	trace_index = i;
	do {
		ray_hit hit;
		trace_chance = hash_combine(chance, bounce) | 1u;
		trace_closest(w.origin, w.direction, w.alive ? INFINITY : -1.0, hit);
		arrive(w, row, hit, bounce, lost);
		bounce++;
		more = MIRRORS && subgroupAny(w.alive);
		if (MIRRORS)
			trace_rounds++;
	} while (more);
	trace_cut = trace_cut || w.alive;
}

// Follow BUNDLE_RAYS of them, WIDTH rows of the table apart, with those of the other lanes between.
void follow_bundle(factor_source s, uint row, uint chance, uint first, inout factor_sums lost)
{
	walker w[BUNDLE_RAYS];
	uint bounce = 0u;
	bool more;
	for (uint k = 0u; k < BUNDLE_RAYS; k++)
		w[k] = start(s, first + k * WIDTH);
	bool alive;
	do {
		ray_bundle rays;
		ray_hit hit[BUNDLE_RAYS];
		for (uint k = 0u; k < BUNDLE_RAYS; k++) {
			rays.origin[k] = w[k].origin;
			rays.direction[k] = w[k].direction;
			rays.t_max[k] = w[k].alive ? INFINITY : -1.0;
			rays.index[k] = first + k * WIDTH;
		}
		trace_chance = hash_combine(chance, bounce) | 1u;
		walk_bundle(rays, hit);
		alive = false;
		for (uint k = 0u; k < BUNDLE_RAYS; k++) {
			arrive(w[k], row, hit[k], bounce, lost);
			alive = alive || w[k].alive;
		}
		bounce++;
		more = MIRRORS && subgroupAny(alive);
		if (MIRRORS)
			trace_rounds++;
	} while (more);
	trace_cut = trace_cut || alive;
}

void main()
{
	uint row = push.first_row + gl_WorkGroupID.y;
	uint element = factor_rows[row];
	uint chance = hash(element);
	factor_source s = source_make(element, push.patches);
	factor_sums lost = factor_sums(0u, 0u);
	uint turn = 0u;
	do {
		uint block = gl_WorkGroupID.x * push.turns + turn;
		if (PACKET) {
			uint packet = block * (FACTOR_LANES / WIDTH) + gl_LocalInvocationIndex / WIDTH;
			follow_bundle(s, row, chance, packet * BUNDLE_RAYS * WIDTH + gl_LocalInvocationIndex % WIDTH, lost);
		} else {
			follow(s, row, chance, block * FACTOR_LANES + gl_LocalInvocationIndex, lost);
		}
		turn++;
		trace_rounds++;
	} while (turn < push.turns);
	if (lost.escaped > 0u)
		atomicAdd(sums[row].escaped, lost.escaped);
	if (lost.cut > 0u)
		atomicAdd(sums[row].cut, lost.cut);
	if (trace_cut || turn < push.turns)
		atomicAdd(counters.cut, 1u);
	atomicMax(counters.loop_rounds, trace_rounds);
}
