// Messages that wait for a socket to take them, in order, some with a descriptor. One thread.
#ifndef CANDIL_FRONT_PARCELS_H
#define CANDIL_FRONT_PARCELS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct parcel {
	struct parcel *next;
	int fd; // the parcel's own; -1: none
	size_t bytes;
	uint8_t message[];
};

// Zeroed: none.
struct parcels {
	struct parcel *first, *last;
	unsigned count; // LIMIT_IPC_QUEUE at most
};

// Put a copy behind the others, with a descriptor of its own where `fd` is one. NULL: done; else why it could not be,
// in words, "it" being who should take them.
const char *parcels_keep(struct parcels *parcels, const void *message, size_t bytes, int fd);

void parcels_drop_first(struct parcels *parcels); // there is one
void parcels_clear(struct parcels *parcels);

// Drop the message that hands over this scene, if it is among them. False: it is not.
bool parcels_take_back(struct parcels *parcels, uint64_t scene);

#endif
