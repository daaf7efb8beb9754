// The folder in which drivers keep compiled code (base/drivers.h), as it was when the daemon started. The fence lets the
// daemon's processes write to that folder alone, so they can neither make it again nor use another of its name.
//
// For the front's one thread.
#ifndef CANDIL_FRONT_CACHE_H
#define CANDIL_FRONT_CACHE_H

#include <limits.h>
#include <sys/types.h>

#include "protocol/limits.h"

struct cache {
	char path[PATH_MAX]; // "": nothing can be kept
	dev_t device;
	ino_t inode;
};

// Find it, and make it, before the fence is up.
void cache_find(struct cache *cache);

// What replies are to tell of it, in a sentence; "": nothing, for it is where it was.
void cache_note(const struct cache *cache, char note[LIMIT_TEXT + 1]);

#endif
