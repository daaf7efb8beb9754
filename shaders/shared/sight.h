// Which pairs of elements of radiosity see each other: radiosity/sight.comp.glsl. Shared by C and GLSL.
#ifndef CANDIL_SHARED_SIGHT_H
#define CANDIL_SHARED_SIGHT_H

#include "shared/patch_pass.h"

// In the places of the passes over patches (patch_pass.h).
#define BIND_SIGHT_PAIRS BIND_PATCH_LIGHT // two elements each
#define BIND_SIGHT_RESULTS BIND_PATCH_SKY // struct sight_result
#define BIND_SIGHT_TABLE BIND_PATCH_SKY_ROWS // points of the probe, then those of the rest

// Rays of an invocation: software drivers end an invocation's loops after some 65,000 rounds in all.
#define SIGHT_AT_ONCE 16u

// Of patch_push, `first` is the first pair, `all` how many invocations have a pair, `count` how many there are in all, and
// `point` where the points begin in the table.

// What an invocation's rays between two elements met. Their weight is the kernel of the form factor, cos θ1 cos θ2 / r²,
// without unit.
struct sight_result {
	float seen; // weight of the rays that nothing stops
	float all; // and of all
	uint free; // rays that nothing stops
	uint rays; // those between points that face each other
};
LAYOUT_ASSERT(sight_result, 16)

#endif
