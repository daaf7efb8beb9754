// A synthetic stream into the path tracer's accumulator: `count` samples of each pixel's own value, in some dispatches.
#version 460
#extension GL_GOOGLE_include_directive : require
#define BIND_ACCUMULATOR 1
#include "common/accumulate.glsl"

layout(local_size_x = 8) in;
layout(push_constant) uniform Push {
	uint first;
	uint count;
} push;
layout(std430, set = 0, binding = 0) readonly buffer Values {
	float values[];   // three a pixel
};

void main()
{
	uint pixel = gl_GlobalInvocationID.x;
	vec3 v = vec3(values[pixel * 3u], values[pixel * 3u + 1u], values[pixel * 3u + 2u]);
	sums_load(pixel);
	for (uint i = 0u; i < push.count; i++) {
		uint n = push.first + i;
		// A firefly now and then: what a plain float sum loses most by.
		sums_add(n & 1u, n % 1000u == 0u ? v * 1e6 : v);
	}
	sums_store(pixel);
}
