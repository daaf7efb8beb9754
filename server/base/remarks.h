// What of a SceneInfo leaves pictures as they are, so that replies to renders pass over it.
#ifndef CANDIL_BASE_REMARKS_H
#define CANDIL_BASE_REMARKS_H

#include <stdint.h>

// Bits by the places in `warnings` and in `ignored`.
struct scene_remarks {
	uint32_t warnings, ignored;
};

#endif
