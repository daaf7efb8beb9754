// Closest and any hit through the scene's BVH, one ray a lane: correct and simple. Other traversals (packets, ray
// tracing hardware) stand behind the same two functions:
//
//   bool trace_closest(vec3 origin, vec3 direction, out ray_hit hit)       everything beyond t = 0
//   bool trace_any(vec3 origin, vec3 direction, float t_max)               0 < t < t_max
//
// t counts in lengths of the direction, which need not be a unit vector. Of hits at the same t the lower triangle id wins,
// so what is hit does not depend on the order in which the tree is walked.
//
// `trace_cut` becomes true if the driver ended a loop before its condition did (some end all loops of an invocation after
// 65,535 rounds): the walk would then have missed geometry without a word.
#ifndef TRACE_TRAVERSE_GLSL
#define TRACE_TRAVERSE_GLSL

#include "common/scene.glsl"
#include "trace/triangle.glsl"

#define TRAVERSE_STACK 48           // LIMIT_BVH_DEPTH, which blob_check enforces
#define TRAVERSE_DONE 0xFFFFFFFFu
#define LEAF_COUNT_SHIFT 28         // a reference: 0 and a node's index, or a leaf's count and its first triangle
#define LEAF_INDEX_MASK 0x0FFFFFFFu

struct ray_hit {
	float t;
	uint id;
	vec2 uv;         // barycentrics of corners 1 and 2
	uint material;
};

bool trace_cut = false;

// Entry distance of a box, or infinity if missed (as an empty child's always is: its box is a point at infinity). The factor makes up for the rounding of three products (Ize 2013).
float hit_box(vec3 low, vec3 high, vec3 origin, vec3 inverse, float t_max)
{
	vec3 a = (low - origin) * inverse;
	vec3 b = (high - origin) * inverse;
	vec3 near = min(a, b);
	vec3 far = max(a, b);
	float enter = max(max(near.x, near.y), max(near.z, 0.0));
	float leave = min(min(far.x, far.y), far.z) * 1.0000005;
	return enter <= min(leave, t_max) ? enter : INFINITY;
}

// No component zero, so that no product is 0 × infinity. 1e-30 turns a ray by nothing that a float can tell.
vec3 safe_inverse(vec3 d)
{
	vec3 sign_d = vec3(d.x < 0.0 ? -1.0 : 1.0, d.y < 0.0 ? -1.0 : 1.0, d.z < 0.0 ? -1.0 : 1.0);
	return sign_d / max(abs(d), vec3(1e-30));
}

bool walk(vec3 origin, vec3 direction, float t_max, bool any, out ray_hit hit)
{
	uint stack[TRAVERSE_STACK];
	uint top = 0u;
	uint current = 0u;
	vec3 inverse = safe_inverse(direction);
	sheared_ray ray = shear_ray(origin, direction);
	hit.t = t_max;
	hit.id = NONE;
	hit.uv = vec2(0.0);
	hit.material = 0u;

	while (current != TRAVERSE_DONE) {
		while (current <= LEAF_INDEX_MASK) {
			vec4 n0 = nodes[current * 4u];
			vec4 n1 = nodes[current * 4u + 1u];
			vec4 n2 = nodes[current * 4u + 2u];
			vec4 n3 = nodes[current * 4u + 3u];
			float d0 = hit_box(n0.xyz, n1.xyz, origin, inverse, hit.t);
			float d1 = hit_box(n2.xyz, n3.xyz, origin, inverse, hit.t);
			uint c0 = floatBitsToUint(n0.w) | floatBitsToUint(n1.w) << LEAF_COUNT_SHIFT;
			uint c1 = floatBitsToUint(n2.w) | floatBitsToUint(n3.w) << LEAF_COUNT_SHIFT;
			bool miss0 = d0 == INFINITY;
			bool miss1 = d1 == INFINITY;
			bool swapped = d1 < d0;
			uint near = swapped ? c1 : c0;
			uint far = swapped ? c0 : c1;
			if (miss0 && miss1) {
				current = TRAVERSE_DONE;
				if (top > 0u)
					current = stack[--top];
			} else {
				current = near;
				if (!miss0 && !miss1)
					stack[top++] = far;
			}
		}
		if (current == TRAVERSE_DONE)
			break;
		uint first = current & LEAF_INDEX_MASK;
		uint last = first + (current >> LEAF_COUNT_SHIFT);
		for (uint i = first; i < last; i++) {
			vec4 v0 = leaf_triangles[i * 3u];
			vec4 v1 = leaf_triangles[i * 3u + 1u];
			vec4 v2 = leaf_triangles[i * 3u + 2u];
			uint id = floatBitsToUint(v0.w);
			float t;
			vec2 uv;
			if (hit_triangle(ray, v0.xyz, v1.xyz, v2.xyz, t, uv) && (t < hit.t || (t == hit.t && id < hit.id && hit.id != NONE))) {
				hit.t = t;
				hit.id = id;
				hit.uv = uv;
				hit.material = floatBitsToUint(v1.w);
			}
		}
		if (any && hit.id != NONE)
			return true;
		current = TRAVERSE_DONE;
		if (top > 0u)
			current = stack[--top];
	}
	trace_cut = trace_cut || current != TRAVERSE_DONE;
	return hit.id != NONE;
}

bool trace_closest(vec3 origin, vec3 direction, out ray_hit hit)
{
	return walk(origin, direction, INFINITY, false, hit);
}

bool trace_any(vec3 origin, vec3 direction, float t_max)
{
	ray_hit hit;
	return walk(origin, direction, t_max, true, hit);
}

#endif
