// Closest and any hit by packets: one subgroup walks the BVH for all its rays together, with one stack. On software devices
// a lane is a part of a vector register. So memory is read once for all lanes, and a loop that all lanes take together
// costs as much as one lane's.
//
// Every lane of the subgroup must call these functions; lanes without a ray pass t_max = -1. Control flow is the same in
// all lanes. The lanes fetch the sixteen words of a node side by side and distribute them by shuffles with constant lanes.
// Votes are one packed sum. The stack is spread over the lanes too: entry i is word i / WIDTH of lane i mod WIDTH.
#ifndef TRACE_PACKET_GLSL
#define TRACE_PACKET_GLSL

#include "common/scene.glsl"
#include "trace/alpha.glsl"
#include "trace/triangle.glsl"
#include "trace/walk.glsl"

// Lanes of a subgroup: 4, 8 or 16.
layout(constant_id = SPEC_WIDTH) const uint WIDTH = 8u;

// The tree is read through texel buffers. Some drivers run storage buffer loads lane by lane, because lanes may be
// inactive, but fetch texels for all lanes at once.
layout(set = 0, binding = BIND_NODE_TEXELS) uniform utextureBuffer node_texels;
layout(set = 0, binding = BIND_LEAF_TEXELS) uniform utextureBuffer leaf_texels;

#define PACKET_STACK_WORDS 12   // × 4 lanes: TRAVERSE_STACK entries at the least width

// Word k of a fetch, in all lanes. Lane i holds the words 4i … 4i + 3.
#define WORD(w, k) subgroupShuffle(w[(k) % 4u], (k) / 4u)
#define WORD_VEC3(w, k) uintBitsToFloat(uvec3(WORD(w, (k)), WORD(w, (k) + 1u), WORD(w, (k) + 2u)))

uvec4 fetch_node(uint index, uint lane)
{
	return texelFetch(node_texels, int(index * 4u + (lane & 3u)));
}

// A triangle is three texels; the fourth lane reads the last one again, to stay within the buffer.
uvec4 fetch_triangle(uint index, uint lane)
{
	return texelFetch(leaf_texels, int(index * 3u + min(lane & 3u, 2u)));
}

// The sum of a value over all lanes, returned in all of them.
uint sum_lanes(uint v)
{
	v += subgroupShuffleXor(v, 1u);
	v += subgroupShuffleXor(v, 2u);
	if (WIDTH > 4u)
		v += subgroupShuffleXor(v, 4u);
	if (WIDTH > 8u)
		v += subgroupShuffleXor(v, 8u);
	return v;
}

struct packet_stack {
	uint words[PACKET_STACK_WORDS];
	uint top;
};

packet_stack stack_make()
{
	packet_stack s;
	s.top = 0u;
	for (uint i = 0u; i < PACKET_STACK_WORDS; i++)
		s.words[i] = 0u;
	return s;
}

// Only constant indices are used: an array indexed by a variable would be kept in memory, not in registers.
void stack_push(inout packet_stack s, uint lane, uint value)
{
	bool mine = s.top % WIDTH == lane;
	uint word = s.top / WIDTH;
	for (uint i = 0u; i < TRAVERSE_STACK / WIDTH; i++)
		s.words[i] = mine && word == i ? value : s.words[i];
	s.top++;
}

uint stack_pop(inout packet_stack s)
{
	if (s.top == 0u)
		return TRAVERSE_DONE;
	s.top--;
	uint word = s.top / WIDTH;
	uint v = s.words[0];
	for (uint i = 1u; i < TRAVERSE_STACK / WIDTH; i++)
		v = word == i ? s.words[i] : v;
	return subgroupShuffle(v, s.top % WIDTH);
}

// The coordinates of three planes; `texel` names, for each axis, the texel that holds it. The shuffle selects by the signs
// of the ray's own direction.
vec3 planes(uvec4 w, uvec3 texel)
{
	return uintBitsToFloat(
	    uvec3(subgroupShuffle(w.x, texel.x), subgroupShuffle(w.y, texel.y), subgroupShuffle(w.z, texel.z)));
}

// The child that more rays hit first. The other, if any ray hits it, goes on the stack; if none hits either, the next is from
// there. The votes have one byte for each count: rays that hit the first child, rays that hit the second, rays to which the
// second is nearer, rays to which the first is nearer.
uint choose_child(uint votes, uint c0, uint c1, uint lane, inout packet_stack stack)
{
	bool any0 = (votes & 0xffu) != 0u;
	bool any1 = (votes & 0xff00u) != 0u;
	bool swapped = !any0 || (any1 && (votes >> 16 & 0xffu) > votes >> 24);
	if (any0 && any1)
		stack_push(stack, lane, swapped ? c0 : c1);
	if (any0 || any1)
		return swapped ? c1 : c0;
	return stack_pop(stack);
}

// One step down from an inner node.
uint step_packet(uint node, uint lane, slab_ray ray, uvec3 first, float t_max, inout packet_stack stack)
{
	uvec4 w = fetch_node(node, lane);
	float d0 = hit_slabs(planes(w, first), planes(w, first ^ 1u), ray, t_max);
	float d1 = hit_slabs(planes(w, first + 2u), planes(w, (first + 2u) ^ 1u), ray, t_max);
	uint c0 = WORD(w, 3u) | WORD(w, 7u) << LEAF_COUNT_SHIFT;
	uint c1 = WORD(w, 11u) | WORD(w, 15u) << LEAF_COUNT_SHIFT;
	uint votes = (d0 < INFINITY ? 1u : 0u) | (d1 < INFINITY ? 0x100u : 0u) | (d1 < d0 ? 0x10000u : 0u) |
		     (d0 < d1 ? 0x1000000u : 0u);
	return choose_child(sum_lanes(votes), c0, c1, lane, stack);
}

// Intersects the triangle whose words the lanes have fetched.
void meet_words(uvec4 w, sheared_ray ray, inout ray_hit hit)
{
	uint id = WORD(w, 3u);
	uint material = WORD(w, 7u);
	float t;
	vec2 uv;
	bool inside = hit_triangle(ray, WORD_VEC3(w, 0u), WORD_VEC3(w, 4u), WORD_VEC3(w, 8u), t, uv);
	bool nearer = inside && (t < hit.t || (t == hit.t && id < hit.id && hit.id != NONE));
	if ((EFFECT_ALPHA_MASK || EFFECT_ALPHA_BLEND) && nearer)
		nearer = is_there(id, material, uv);
	hit.t = nearer ? t : hit.t;
	hit.id = nearer ? id : hit.id;
	hit.uv = nearer ? uv : hit.uv;
	hit.material = nearer ? material : hit.material;
}

void test_packet(uint index, uint lane, sheared_ray ray, inout ray_hit hit)
{
	meet_words(fetch_triangle(index, lane), ray, hit);
}

bool walk_packet(vec3 origin, vec3 direction, float t_max, bool any, out ray_hit hit)
{
	uint lane = gl_SubgroupInvocationID;
	packet_stack stack = stack_make();
	slab_ray slabs = slab_make(origin, direction);
	uvec3 first = uvec3(lessThan(slabs.inverse, vec3(0.0)));   // 1 where the upper plane is the nearer one
	sheared_ray ray = shear_ray(origin, direction);
	hit.t = t_max;
	hit.id = NONE;
	hit.uv = vec2(0.0);
	hit.material = 0u;

	// All loops test their condition at the end: a driver without branches runs the body of a loop that tests at the
	// start once more than needed.
	uint current = 0u;
	do {
		do {
			current = step_packet(current, lane, slabs, first, hit.t, stack);
			trace_rounds++;
		} while (current <= LEAF_INDEX_MASK);
		trace_cut = trace_cut || current <= LEAF_INDEX_MASK;
		// Leaves that follow one another are tested in this loop.
		uint i = current & LEAF_INDEX_MASK;
		uint last = i + (current >> LEAF_COUNT_SHIFT);
		bool leaf = current != TRAVERSE_DONE && !trace_cut;
		if (leaf) do {
			test_packet(i, lane, ray, hit);
			i++;
			trace_rounds++;
			if (any) // a ray that has its answer stops searching
				hit.t = hit.id != NONE ? -1.0 : hit.t;
			if (i == last) {
				current = stack_pop(stack);
				i = current & LEAF_INDEX_MASK;
				last = i + (current >> LEAF_COUNT_SHIFT);
				leaf = current > LEAF_INDEX_MASK && current != TRAVERSE_DONE;
			}
		} while (leaf);
		trace_cut = trace_cut || leaf;
		if (any && sum_lanes(hit.t > 0.0 ? 1u : 0u) == 0u)
			current = TRAVERSE_DONE;
	} while (current != TRAVERSE_DONE && !trace_cut);
	trace_cut = trace_cut || current != TRAVERSE_DONE;
	return hit.id != NONE;
}

#endif
