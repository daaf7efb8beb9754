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
	// Numbers stay words: as a float a small one is subnormal, which may be flushed to zero.
	uvec4 w0 = LEAF_WORDS(i * 3u);
	uvec4 w1 = LEAF_WORDS(i * 3u + 1u);
	vec3 v0 = uintBitsToFloat(w0.xyz);
	vec3 v1 = uintBitsToFloat(w1.xyz);
	vec3 v2 = uintBitsToFloat(LEAF_WORDS(i * 3u + 2u).xyz);
	uint id = w0.w;
	float t;
	vec2 uv;
	if (hit_triangle(ray, v0, v1, v2, t, uv) && (t < hit.t || (t == hit.t && id < hit.id && hit.id != NONE)) &&
	    (!(EFFECT_ALPHA_MASK || EFFECT_ALPHA_BLEND) || is_there(id, w1.w, uv))) {
		hit.t = t;
		hit.id = id;
		hit.uv = uv;
		hit.material = w1.w;
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
			uvec4 w0 = NODE_WORDS(current * 4u);
			uvec4 w1 = NODE_WORDS(current * 4u + 1u);
			uvec4 w2 = NODE_WORDS(current * 4u + 2u);
			uvec4 w3 = NODE_WORDS(current * 4u + 3u);
			vec3 n0 = uintBitsToFloat(w0.xyz);
			vec3 n1 = uintBitsToFloat(w1.xyz);
			vec3 n2 = uintBitsToFloat(w2.xyz);
			vec3 n3 = uintBitsToFloat(w3.xyz);
			float d0 = hit_slabs(mix(n0, n1, upper), mix(n1, n0, upper), slabs, hit.t);
			float d1 = hit_slabs(mix(n2, n3, upper), mix(n3, n2, upper), slabs, hit.t);
			uint c0 = w0.w | w1.w << LEAF_COUNT_SHIFT;
			uint c1 = w2.w | w3.w << LEAF_COUNT_SHIFT;
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
