// The sum of a pixel's samples, compensated: (hi, lo) by Knuth's exact two-sum, renormalised by Dekker's, so that 10⁶ and
// more samples lose nothing that shows. Samples are added in the order of their index, whatever the slices were.
#ifndef PATH_ACCUMULATE_GLSL
#define PATH_ACCUMULATE_GLSL

#include "shared/bindings.h"

layout(std430, set = 0, binding = BIND_ACCUMULATOR) buffer Accumulator {
	vec2 accumulator[];   // per pixel: half A R G B, half B R G B
};

// sum + x. Both are brought back to hi = the sum rounded and lo = the rest each time: a rest that were only ever added to
// would grow until it lost small samples itself (6·10⁻⁵ after a million samples with fireflies among them).
vec2 add_compensated(vec2 sum, float x)
{
	precise float s = sum.x + x;
	precise float part = s - sum.x;
	precise float error = (sum.x - (s - part)) + (x - part);
	precise float rest = sum.y + error;
	precise float hi = s + rest;
	precise float lo = rest - (hi - s);
	return vec2(hi, lo);
}

void accumulate(uint pixel, uint sample_half, vec3 value)
{
	uint at = pixel * (ACCUMULATOR_FLOATS / 2) + sample_half * 3u;
	accumulator[at] = add_compensated(accumulator[at], value.r);
	accumulator[at + 1u] = add_compensated(accumulator[at + 1u], value.g);
	accumulator[at + 2u] = add_compensated(accumulator[at + 2u], value.b);
}

#endif
