// Taking rows of the matrix of form factors out of a dense buffer (server/worker/technique/radiosity/factors.h). Shared by C
// and GLSL.
#ifndef CANDIL_SHARED_FACTORS_H
#define CANDIL_SHARED_FACTORS_H

#include "shared/layout.h"

#define BIND_FACTORS_DENSE 0 // uint: rows of `side` words
#define BIND_FACTORS_COUNTS 1 // uint, by row of the batch and lane
#define BIND_FACTORS_COLUMNS 2 // uint, of a block
#define BIND_FACTORS_VALUES 3 // float, of a block
#define BIND_FACTORS_COUNT 4

// A row is cut into so many parts side by side, a lane each.
#define FACTORS_LANES 64

struct factors_push {
	uint side;
	uint first_row; // of the batch; a workgroup is a row
	uint writes; // 0: count what is not zero into the counts; else write it from the entry on that is there
	float scale; // a word is a factor of this
};
LAYOUT_ASSERT(factors_push, 16)

#endif
