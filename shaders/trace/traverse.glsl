// Closest and any hit through the scene's BVH, by packet or by single ray, as the pipeline is specialised:
//
//     bool trace_closest(vec3 origin, vec3 direction, float t_max, out ray_hit hit)      0 < t, infinite t_max; or -1: no ray
//     bool trace_any(vec3 origin, vec3 direction, float t_max)                           0 < t < t_max; or -1: no ray
//
//     void walk_bundle(ray_bundle rays, out ray_hit hit[BUNDLE_RAYS])      closest hits; with TRACE_BUNDLES, where PACKET
//
// All lanes of a subgroup must call them together; a lane without a ray passes t_max = -1. t is in units of the length of
// `direction`, which need not be 1. Of hits at the same t, the lower triangle id wins. So the result does not depend on the
// order in which the tree is walked, and both walks give the same.
#ifndef TRACE_TRAVERSE_GLSL
#define TRACE_TRAVERSE_GLSL

#ifdef TRACE_BUNDLES
#include "trace/bundle.glsl"
#endif
#include "trace/packet.glsl"
#include "trace/single.glsl"

layout(constant_id = SPEC_PACKET) const bool PACKET = false;

bool trace_closest(vec3 origin, vec3 direction, float t_max, out ray_hit hit)
{
	if (PACKET)
		return walk_packet(origin, direction, t_max, false, hit);
	return walk_single(origin, direction, t_max, false, hit);
}

bool trace_any(vec3 origin, vec3 direction, float t_max)
{
	ray_hit hit;
	if (PACKET)
		return walk_packet(origin, direction, t_max, true, hit);
	return walk_single(origin, direction, t_max, true, hit);
}

#endif
