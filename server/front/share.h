// The rule by which peers (peer.h) share what there is a number of.
#ifndef CANDIL_FRONT_SHARE_H
#define CANDIL_FRONT_SHARE_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/limits.h"

// May a peer that has `has` take `more`, where `left` are free? All are below 2^60.
static inline bool share_allows(uint64_t has, uint64_t more, uint64_t left)
{
	return more <= left && (has == 0 || has + more <= LIMIT_SHARE * (left - more));
}

#endif
