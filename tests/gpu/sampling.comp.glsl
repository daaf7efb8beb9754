// Points of the sampler, as many as there are invocations: bits of x and y.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/bindings.h"
#include "common/sampling.glsl"

layout(local_size_x = 64) in;
layout(push_constant) uniform Push {
	uint pixel;
	uint sample_half;
	uint set;
	uint seed;
} push;
layout(std430, set = 0, binding = 0) readonly buffer Unused {
	uint unused[];
};
layout(std430, set = 0, binding = 1) writeonly buffer Points {
	uvec2 points[];
};

void main()
{
	uint i = gl_GlobalInvocationID.x;
	points[i] = sample_bits(sampler_make(push.pixel, push.sample_half, i, push.seed, 0u), push.set);
}
