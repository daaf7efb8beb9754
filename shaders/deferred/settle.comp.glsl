// Reads one texel by each of the samplers that a program may have, so that the driver's state of all of them is the same
// afterwards, whichever programs ran before (server/worker/gl/settle.h says why).
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "shared/settle.h"

layout(local_size_x = 1) in;
layout(binding = SETTLE_UNIT) uniform sampler2D slots[SETTLE_SAMPLERS];
layout(location = 0) uniform uint never;    // 0
layout(std430, binding = 0) buffer Out {
	vec4 sum;
};

void main()
{
	vec4 all = vec4(0);
	for (int i = 0; i < SETTLE_SAMPLERS; i++)
		all += texelFetch(slots[i], ivec2(0), 0);
	if (never != 0u)
		sum = all;
}
