// The room that a folder of compiled shaders needs on its disk. Mesa maps the index of its cache as a file with holes; where
// the disk has no block for what is written there, the kernel answers by SIGBUS. One thread.
#ifndef CANDIL_WORKER_CACHE_H
#define CANDIL_WORKER_CACHE_H

#include <stdbool.h>

// Is there room for a few more shaders and the index, in the quota of this user and below the limit of a file's size? What
// cannot be found out counts as room. Fills the holes of an index that is there. Leaves no file, not even if killed.
bool cache_has_room(const char *folder);

// Fill the holes of the index that a driver may have made since, while there is room.
void cache_fill_index(const char *folder);

// Tell the drivers by their variables to keep nothing.
void cache_turn_off(void);

#endif
