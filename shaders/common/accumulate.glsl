// The compensated sum of a pixel's samples: a pair (hi, lo), by Knuth's exact two-sum and renormalised by Dekker's method,
// so that a million samples and more lose nothing visible. Samples are added in the order of their index, however the work
// is sliced.
#ifndef PATH_ACCUMULATE_GLSL
#define PATH_ACCUMULATE_GLSL

#include "shared/bindings.h"

#ifdef VULKAN
#define ACCUMULATOR_BUFFER layout(std430, set = 0, binding = BIND_ACCUMULATOR)
#else
#define ACCUMULATOR_BUFFER layout(std430, binding = BIND_ACCUMULATOR)
#endif

ACCUMULATOR_BUFFER buffer Accumulator {
	vec2 accumulator[];   // per pixel: half A R G B, half B R G B
};

// Returns sum + x. Every addition renormalises the pair: hi is the rounded sum, lo the remainder. A remainder that was only
// ever added to would grow until it lost small samples itself (measured: a relative error of 6·10⁻⁵ after a million samples
// with fireflies among them).
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

// The sums of one pixel while its lane adds to them. Memory is read once and written once.
vec2 sums[ACCUMULATOR_FLOATS / 2];

void sums_load(uint pixel)
{
	for (uint i = 0u; i < ACCUMULATOR_FLOATS / 2u; i++)
		sums[i] = accumulator[pixel * (ACCUMULATOR_FLOATS / 2) + i];
}

void sums_add(uint sample_half, vec3 value)
{
	bool a = sample_half == 0u;
	for (uint i = 0u; i < 3u; i++) {
		vec2 sum = add_compensated(a ? sums[i] : sums[3u + i], value[i]);
		sums[i] = a ? sum : sums[i];
		sums[3u + i] = a ? sums[3u + i] : sum;
	}
}

void sums_store(uint pixel)
{
	for (uint i = 0u; i < ACCUMULATOR_FLOATS / 2u; i++)
		accumulator[pixel * (ACCUMULATOR_FLOATS / 2) + i] = sums[i];
}

#endif
