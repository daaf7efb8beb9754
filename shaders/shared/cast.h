// Rays in, hits out: the pass of trace/cast.comp.glsl, for tests and benchmarks of the traversal. Shared by C and GLSL.
#ifndef CANDIL_SHARED_CAST_H
#define CANDIL_SHARED_CAST_H

#include "shared/bindings.h"

#define BIND_RAYS 15 // struct cast_ray
#define BIND_HITS 16 // struct cast_hit

struct cast_ray {
	float origin[3];
	float t_max;
	float direction[3];
	uint reserved;
};
LAYOUT_ASSERT(cast_ray, 32)

struct cast_hit {
	float t;
	uint id; // triangle id; NONE: nothing hit. For any: 0 if something was hit
	float u;
	float v;
};
LAYOUT_ASSERT(cast_hit, 16)

#endif
