// Room for encoded images that wait to be sent. Only sums: no clock, no process, no connection.
//
// A connection may have LIMIT_IMAGE_BYTES of them, one alone even more. The first LIMIT_OWN_IMAGE_BYTES are its own, so that
// a small picture never waits for what others do not read. What does not fit there lies in the common room of
// LIMIT_COMMON_IMAGE_BYTES; one image may be larger than all of it if it has the room for itself. So at most
// LIMIT_CONNECTIONS × LIMIT_OWN_IMAGE_BYTES + LIMIT_COMMON_IMAGE_BYTES wait, or that one image instead of the last term.
//
// Whoever has room needs nothing else to be sent and give it back, so that nobody waits in a circle.
#ifndef CANDIL_FRONT_JOBS_ROOM_H
#define CANDIL_FRONT_JOBS_ROOM_H

#include <stdbool.h>
#include <stdint.h>

// What is taken, by everybody in the daemon or by one connection. Zeroed is nothing.
struct room {
	uint64_t own, common; // bytes
};

enum room_kind { ROOM_NONE, ROOM_OWN, ROOM_COMMON };

// Where one image lies. Zeroed is nowhere.
struct room_place {
	enum room_kind kind;
	uint64_t bytes;
};

enum room_answer {
	ROOM_TAKEN,
	ROOM_CONNECTION_FULL, // the connection's own images are in the way
	ROOM_COMMON_FULL, // those of all are
};

// Take room for an image of a connection, whose `place` is nowhere so far. `own_only`: others wait for common room.
enum room_answer room_take(struct room *all, struct room *connection, struct room_place *place, uint64_t bytes,
			   bool own_only);

// The image has been made, and is of another size than was thought.
void room_resize(struct room *all, struct room *connection, struct room_place *place, uint64_t bytes);

// The image is gone. Nothing for one that is nowhere.
void room_give_back(struct room *all, struct room *connection, struct room_place *place);

uint64_t room_bytes(const struct room *room);

#endif
