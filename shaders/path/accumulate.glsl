// The sum of a pixel's samples, compensated: (hi, lo) after Knuth's exact two-sum, so that 10⁶ and more samples lose nothing
// that shows. Samples are added in the order of their index, whatever the slices were.
#ifndef PATH_ACCUMULATE_GLSL
#define PATH_ACCUMULATE_GLSL

#include "shared/bindings.h"

layout(std430, set = 0, binding = BIND_ACCUMULATOR) buffer Accumulator {
	vec2 accumulator[];   // per pixel: half A R G B, half B R G B
};

vec2 two_sum(vec2 sum, float x)
{
	precise float hi = sum.x + x;
	precise float part = hi - sum.x;
	precise float error = (sum.x - (hi - part)) + (x - part);
	precise float lo = sum.y + error;
	return vec2(hi, lo);
}

void accumulate(uint pixel, uint sample_half, vec3 value)
{
	uint at = pixel * (ACCUMULATOR_FLOATS / 2) + sample_half * 3u;
	accumulator[at] = two_sum(accumulator[at], value.r);
	accumulator[at + 1u] = two_sum(accumulator[at + 1u], value.g);
	accumulator[at + 2u] = two_sum(accumulator[at + 2u], value.b);
}

#endif
