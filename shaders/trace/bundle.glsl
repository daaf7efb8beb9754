// Closest hits of several rays a lane by one packet: what the rays of a packet share (the node, the stack, the votes) is paid
// once for all of them. It pays where they run nearly side by side; rays that part walk each other's nodes. Hits are those of
// the other walks, bit for bit.
//
// Measured on rows of form factors (tests/bench/RESULTS.md), whose rays start on one patch and are sorted by direction: in a
// room 4 rays a lane trace 1.7 times as many a second as one, 2 rays 1.4 times, and 8 no more than 4. In a long street, where
// rays part, it makes no difference.
#ifndef TRACE_BUNDLE_GLSL
#define TRACE_BUNDLE_GLSL

#include "trace/packet.glsl"

// Rays of a lane. Those without one have t_max = -1.
struct ray_bundle {
	vec3 origin[BUNDLE_RAYS];
	vec3 direction[BUNDLE_RAYS];
	float t_max[BUNDLE_RAYS];
	uint index[BUNDLE_RAYS];   // trace_index of each
};

// Prepared for the intersection with boxes and triangles.
struct bundle_ready {
	slab_ray slabs[BUNDLE_RAYS];
	uvec3 first[BUNDLE_RAYS];   // 1 where the upper plane is the nearer one
	sheared_ray rays[BUNDLE_RAYS];
};

// step_packet, with the votes of all rays.
uint step_bundle(uint node, uint lane, bundle_ready p, ray_hit hit[BUNDLE_RAYS], inout packet_stack stack)
{
	uvec4 w = fetch_node(node, lane);
	uint c0 = WORD(w, 3u) | WORD(w, 7u) << LEAF_COUNT_SHIFT;
	uint c1 = WORD(w, 11u) | WORD(w, 15u) << LEAF_COUNT_SHIFT;
	uint votes = 0u;
	for (int i = 0; i < BUNDLE_RAYS; i++) {
		uvec3 first = p.first[i];
		float d0 = hit_slabs(planes(w, first), planes(w, first ^ 1u), p.slabs[i], hit[i].t);
		float d1 = hit_slabs(planes(w, first + 2u), planes(w, (first + 2u) ^ 1u), p.slabs[i], hit[i].t);
		votes += (d0 < INFINITY ? 1u : 0u) | (d1 < INFINITY ? 0x100u : 0u) | (d1 < d0 ? 0x10000u : 0u) |
			 (d0 < d1 ? 0x1000000u : 0u);
	}
	return choose_child(sum_lanes(votes), c0, c1, lane, stack);
}

void test_bundle(uint index, uint lane, bundle_ready p, ray_bundle rays, inout ray_hit hit[BUNDLE_RAYS])
{
	uvec4 w = fetch_triangle(index, lane);
	for (int i = 0; i < BUNDLE_RAYS; i++) {
		trace_index = rays.index[i];
		meet_words(w, p.rays[i], hit[i]);
	}
}

void walk_bundle(ray_bundle rays, out ray_hit hit[BUNDLE_RAYS])
{
	uint lane = gl_SubgroupInvocationID;
	packet_stack stack = stack_make();
	bundle_ready p;
	for (int i = 0; i < BUNDLE_RAYS; i++) {
		p.slabs[i] = slab_make(rays.origin[i], rays.direction[i]);
		p.first[i] = uvec3(lessThan(p.slabs[i].inverse, vec3(0.0)));
		p.rays[i] = shear_ray(rays.origin[i], rays.direction[i]);
		hit[i] = ray_hit(rays.t_max[i], NONE, vec2(0.0), 0u);
	}
	// As walk_packet, which see.
	uint current = 0u;
	do {
		do {
			current = step_bundle(current, lane, p, hit, stack);
			trace_rounds++;
		} while (current <= LEAF_INDEX_MASK);
		trace_cut = trace_cut || current <= LEAF_INDEX_MASK;
		uint i = current & LEAF_INDEX_MASK;
		uint last = i + (current >> LEAF_COUNT_SHIFT);
		bool leaf = current != TRAVERSE_DONE && !trace_cut;
		if (leaf) do {
			test_bundle(i, lane, p, rays, hit);
			i++;
			trace_rounds++;
			if (i == last) {
				current = stack_pop(stack);
				i = current & LEAF_INDEX_MASK;
				last = i + (current >> LEAF_COUNT_SHIFT);
				leaf = current > LEAF_INDEX_MASK && current != TRAVERSE_DONE;
			}
		} while (leaf);
		trace_cut = trace_cut || leaf;
	} while (current != TRAVERSE_DONE && !trace_cut);
	trace_cut = trace_cut || current != TRAVERSE_DONE;
}

#endif
