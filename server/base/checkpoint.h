// Where a technique with noise compares its error with a target: after 8, 12, 16, 24, 32, 48… samples. These numbers are
// fixed, so the same request always ends at the same one. Any thread.
#ifndef CANDIL_BASE_CHECKPOINT_H
#define CANDIL_BASE_CHECKPOINT_H

#include <stdint.h>

#define CHECKPOINT_FIRST 8u // an estimate from fewer samples is too uncertain

// The least checkpoint above `samples`, which are fewer than 2³⁰.
static inline uint32_t checkpoint_after(uint32_t samples)
{
	uint32_t at = CHECKPOINT_FIRST;
	// They are 2^k and 3·2^(k-1) in turns.
	while (at <= samples)
		at += (at & (at - 1)) == 0 ? at / 2 : at / 3;
	return at;
}

#endif
