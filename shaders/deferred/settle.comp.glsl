// Reads one texel by each of the samplers that a program may have, so that the driver's state of all of them is the same
// afterwards, whichever programs ran before (server/worker/gl/settle.h says why). Its buffers and its image take the places
// of those before: what was deleted is freed only then.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "shared/settle.h"

layout(local_size_x = 1) in;
layout(binding = SETTLE_UNIT) uniform sampler2D slots[SETTLE_SAMPLERS];
layout(binding = 0, r8) uniform writeonly image2D image;
layout(location = 0) uniform uint never;    // 0
layout(std430, binding = 0) buffer Out {
	vec4 sum;
} outs[SETTLE_BUFFERS];

void main()
{
	vec4 all = vec4(0);
	for (int i = 0; i < SETTLE_SAMPLERS; i++)
		all += texelFetch(slots[i], ivec2(0), 0);
	if (never != 0u) {
		for (int i = 0; i < SETTLE_BUFFERS; i++)
			outs[i].sum = all;
		imageStore(image, ivec2(0), all);
	}
}
