// Closest and any hit, one ray for each lane, each with its own stack. It suits GPUs best, and is the plain reference for
// packets.
#ifndef TRACE_SINGLE_GLSL
#define TRACE_SINGLE_GLSL

#include "trace/alpha.glsl"
#include "trace/triangle.glsl"
#include "trace/walk.glsl"

// Intersects triangle `i` of the leaves. It becomes the hit if it is nearer, or as near with a lower id. So the result does
// not depend on the order.
void meet_triangle(uint i, sheared_ray ray, inout ray_hit hit)
{
	vec4 v0 = LEAF_WORDS(i * 3u);
	vec4 v1 = LEAF_WORDS(i * 3u + 1u);
	vec4 v2 = LEAF_WORDS(i * 3u + 2u);
	uint id = floatBitsToUint(v0.w);
	float t;
	vec2 uv;
	if (hit_triangle(ray, v0.xyz, v1.xyz, v2.xyz, t, uv) && (t < hit.t || (t == hit.t && id < hit.id && hit.id != NONE)) &&
	    (!(EFFECT_ALPHA_MASK || EFFECT_ALPHA_BLEND) || is_there(id, floatBitsToUint(v1.w), uv))) {
		hit.t = t;
		hit.id = id;
		hit.uv = uv;
		hit.material = floatBitsToUint(v1.w);
	}
}

bool walk_single(vec3 origin, vec3 direction, float t_max, bool any, out ray_hit hit)
{
	uint stack[TRAVERSE_STACK];
	uint top = 0u;
	uint current = 0u;
	slab_ray slabs = slab_make(origin, direction);
	bvec3 upper = lessThan(slabs.inverse, vec3(0.0));
	sheared_ray ray = shear_ray(origin, direction);
	hit.t = t_max;
	hit.id = NONE;
	hit.uv = vec2(0.0);
	hit.material = 0u;

	while (current != TRAVERSE_DONE) {
		while (current <= LEAF_INDEX_MASK) {
			trace_rounds++;
			vec4 n0 = NODE_WORDS(current * 4u);
			vec4 n1 = NODE_WORDS(current * 4u + 1u);
			vec4 n2 = NODE_WORDS(current * 4u + 2u);
			vec4 n3 = NODE_WORDS(current * 4u + 3u);
			float d0 = hit_slabs(mix(n0.xyz, n1.xyz, upper), mix(n1.xyz, n0.xyz, upper), slabs, hit.t);
			float d1 = hit_slabs(mix(n2.xyz, n3.xyz, upper), mix(n3.xyz, n2.xyz, upper), slabs, hit.t);
			uint c0 = floatBitsToUint(n0.w) | floatBitsToUint(n1.w) << LEAF_COUNT_SHIFT;
			uint c1 = floatBitsToUint(n2.w) | floatBitsToUint(n3.w) << LEAF_COUNT_SHIFT;
			bool hit0 = d0 < INFINITY;
			bool hit1 = d1 < INFINITY;
			bool swapped = d1 < d0;
			if (hit0 || hit1) {
				current = swapped ? c1 : c0;
				if (hit0 && hit1)
					stack[top++] = swapped ? c0 : c1;
			} else {
				current = top > 0u ? stack[--top] : TRAVERSE_DONE;
			}
		}
		trace_cut = trace_cut || current <= LEAF_INDEX_MASK;
		if (current == TRAVERSE_DONE || trace_cut)
			break;
		uint first = current & LEAF_INDEX_MASK;
		uint last = first + (current >> LEAF_COUNT_SHIFT);
		uint i = first;
		for (; i < last; i++) {
			trace_rounds++;
			meet_triangle(i, ray, hit);
		}
		trace_cut = trace_cut || i != last;
		if (any && hit.id != NONE)
			return true;
		current = top > 0u ? stack[--top] : TRAVERSE_DONE;
	}
	trace_cut = trace_cut || current != TRAVERSE_DONE;
	return hit.id != NONE;
}

#endif
