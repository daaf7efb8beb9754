// Rows of a dense buffer become rows of a sparse matrix: first each lane counts what is not zero in its part of a row, then,
// when the host has told it where its entries go, it writes them. Lanes share nothing, so columns ascend whatever the device.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "shared/factors.h"

layout(local_size_x = FACTORS_LANES) in;

layout(push_constant) uniform Push {
	factors_push push;
};
layout(std430, set = 0, binding = BIND_FACTORS_DENSE) readonly buffer Dense {
	uint dense[];
};
layout(std430, set = 0, binding = BIND_FACTORS_COUNTS) buffer Counts {
	uint counts[];
};
layout(std430, set = 0, binding = BIND_FACTORS_COLUMNS) writeonly buffer Columns {
	uint columns[];
};
layout(std430, set = 0, binding = BIND_FACTORS_VALUES) writeonly buffer Values {
	float values[];
};

void main()
{
	uint row = push.first_row + gl_WorkGroupID.x;
	uint lane = row * FACTORS_LANES + gl_LocalInvocationIndex;
	uint part = (push.side + FACTORS_LANES - 1u) / FACTORS_LANES;
	uint first = min(gl_LocalInvocationIndex * part, push.side);
	uint end = min(first + part, push.side);
	uint at = push.writes != 0u ? counts[lane] : 0u;
	for (uint i = first; i < end; i++) {
		uint word = dense[row * push.side + i];
		if (word != 0u && push.writes != 0u) {
			columns[at] = i;
			values[at] = float(word) * push.scale;
		}
		at += word != 0u ? 1u : 0u;
	}
	if (push.writes == 0u)
		counts[lane] = at;
}
