// Rays between points of pairs of elements, SIGHT_AT_ONCE of them an invocation. The points are those of a table of Sobol' points in four
// dimensions, two for each element, rotated for each pair (Cranley and Patterson 1976).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require

#include "common/surface.glsl"
#include "trace/traverse.glsl"
#include "shared/sight.h"

layout(local_size_x = PATCH_GROUP) in;

layout(constant_id = SPEC_PATCH_COUNT) const uint PATCH_COUNT = 0u;

layout(push_constant) uniform Push {
	patch_push push;
};
layout(std430, set = 0, binding = BIND_COUNTERS) buffer Counters {
	pass_counters counters;
};
layout(std430, set = 0, binding = BIND_SIGHT_PAIRS) readonly buffer Pairs {
	uvec2 pairs[];
};
layout(std430, set = 0, binding = BIND_SIGHT_TABLE) readonly buffer Table {
	uvec4 sight_table[];
};
layout(std430, set = 0, binding = BIND_SIGHT_RESULTS) buffer Results {
	sight_result results[];
};
#include "radiosity/patch_point.glsl"

// A point of an element.
struct end {
	vec3 at;
	vec3 normal;   // unit, on the element's side
	float weight;
	corners k;
	uvec2 own;     // triangles of its face
};

end end_at(uint element, vec2 u)
{
	bool back = element >= PATCH_COUNT;
	uint i = back ? element - PATCH_COUNT : element;
	uint face = radiosity_patches[i].face;
	patch_point p = patch_point_at(i, face, u);
	end e;
	e.own = patch_triangles[face];
	e.k = corners_of(triangles[p.id]);
	e.at = point_inside(e.k, p.uv, position_error(e.k));
	e.normal = back ? -e.k.normal : e.k.normal;
	e.weight = p.weight;
	return e;
}

// Whether something between two ends stops a ray. A flat face hides neither itself nor what is in front of it, but rounding may
// find it in a ray's way where it is a sliver: barycentrics of places on it have no digits there.
bool stopped(end a, end b, vec3 from, vec3 way, bool some)
{
	bool met = trace_any(from, way, some ? 1.0 : -1.0);
	ray_hit hit;
	bool found = trace_closest(from, way, met ? INFINITY : -1.0, hit);
	bool own = found && (any(equal(a.own, uvec2(hit.id))) || any(equal(b.own, uvec2(hit.id))));
	return met && !own;
}

void main()
{
	bool mine = gl_GlobalInvocationID.x < push.count;
	uint slot = mine ? gl_GlobalInvocationID.x : 0u;
	uvec2 pair = pairs[push.first + slot / push.all];
	uint point = slot % push.all * SIGHT_AT_ONCE;
	// Lengths in units of the first patch's: squares of squares stay in a float's range.
	float unit = inversesqrt(max(radiosity_patches[pair.x >= PATCH_COUNT ? pair.x - PATCH_COUNT : pair.x].area, 1e-30));
	uint h = hash_combine(hash(pair.x), pair.y);
	uvec4 turn = uvec4(hash(h ^ 0x68bc21ebu), hash(h ^ 0x02e5be93u), hash(h ^ 0x967a889bu), hash(h ^ 0x368cc8b7u));
	sight_result r = sight_result(0.0, 0.0, 0u, 0u);
	for (uint k = 0u; k < SIGHT_AT_ONCE; k++) {
		vec4 u = vec4((sight_table[push.point + point + k] + turn) >> 8) * UNIT_24;
		end a = end_at(pair.x, u.xy);
		end b = end_at(pair.y, u.zw);
		vec3 way = (b.at - a.at) * unit;
		float d2 = max(dot(way, way), 1e-30);
		float weight = max(dot(a.normal, way), 0.0) * max(-dot(b.normal, way), 0.0) / (d2 * d2) * a.weight * b.weight;
		float off_a = start_offset(a.k, a.at);
		vec3 from = a.at + off_a * a.normal;
		float off_b = segment_offset(b.k, from);
		vec3 to = b.at + off_b * b.normal;
		// A ray tells nothing whose ends are as close to the other's plane as they are moved off their own: beyond that
		// plane it meets the two themselves, and near it rounding decides whether it does.
		bool some = mine && weight > 0.0 && dot(a.normal, to - a.at) > off_a && dot(b.normal, from - b.at) > off_b;
		if (EFFECT_ALPHA_BLEND) {
			trace_chance = h | 1u;
			trace_index = point + k;
		}
		bool met = stopped(a, b, from, to - from, some);
		r.all += some ? weight : 0.0;
		r.rays += some ? 1u : 0u;
		r.seen += some && !met ? weight : 0.0;
		r.free += some && !met ? 1u : 0u;
	}
	if (!mine)
		return;
	results[slot] = r;
	if (trace_cut)
		atomicAdd(counters.cut, 1u);
}
