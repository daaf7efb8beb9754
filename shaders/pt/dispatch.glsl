// What the two passes that follow paths share, from the camera and from the lamps: the range of a dispatch, paths that wait
// for the next one, and the counters that the host reads.
#ifndef PATH_DISPATCH_GLSL
#define PATH_DISPATCH_GLSL

#include "common/scene.glsl"
#include "trace/traverse.glsl"
#include "shared/pt.h"

layout(push_constant) uniform Push {
	path_push push;
};
layout(std430, set = 0, binding = BIND_PATHS) buffer Paths {
	path_state paths[];
};
layout(std430, set = 0, binding = BIND_COUNTERS) buffer Counters {
	pass_counters counters;
	uint met[];
};
#include "common/met.glsl"

// Whether a path may be longer than a dispatch. If not, no storage for waiting paths is needed.
layout(constant_id = SPEC_RESUMED) const bool RESUMED = true;

// Number of events before which Russian roulette never ends a path.
const uint ROULETTE_FROM = 4u;

// Adds an invocation's work to the host's counters.
void count_work(uint rays, uint non_finite, uint rounds)
{
	atomicAdd(counters.rays, rays);
	if (non_finite > 0u)
		atomicAdd(counters.non_finite, non_finite);
	if (trace_cut)
		atomicAdd(counters.cut, 1u);
	atomicMax(counters.loop_rounds, trace_rounds + rounds);
}

#endif
