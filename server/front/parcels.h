// Messages that wait for a socket to take them, in order, some of them with a descriptor. For the front's one thread
// (loop.h).
#ifndef CANDIL_FRONT_PARCELS_H
#define CANDIL_FRONT_PARCELS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct parcel {
	struct parcel *next;
	int fd; // of a scene's blob, which stays the scene's; -1: none
	size_t bytes;
	uint8_t message[];
};

// Zeroed: none.
struct parcels {
	struct parcel *first, *last;
	unsigned count; // LIMIT_IPC_QUEUE at most
};

// Put a copy of a message behind the others. `fd` (negative: none) stays the caller's, who keeps it open until the message
// is dropped: parcels_take_back before a scene goes. NULL: done; else the reason in words, in which "it" is whoever should
// take the messages.
const char *parcels_keep(struct parcels *parcels, const void *message, size_t bytes, int fd);

// Drop the first message, which there must be.
void parcels_drop_first(struct parcels *parcels);

// Drop all.
void parcels_clear(struct parcels *parcels);

// Drop the message that hands over this scene. False: there is none.
bool parcels_take_back(struct parcels *parcels, uint64_t scene);

#endif
