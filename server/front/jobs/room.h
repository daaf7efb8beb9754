// Room for encoded images that wait to be sent. Only sums: no clock, no process, no connection.
//
// A connection may have LIMIT_IMAGE_BYTES of images, or one that is larger. The first LIMIT_OWN_IMAGE_BYTES are its own, so
// that a small picture never waits for what others do not read. An image that does not fit there lies in the common room of
// LIMIT_COMMON_IMAGE_BYTES; one that is larger than all of it may have it for itself. So what waits is at most
// LIMIT_CONNECTIONS × LIMIT_OWN_IMAGE_BYTES + LIMIT_COMMON_IMAGE_BYTES, or that one image in place of the last term.
//
// Each image has a descriptor, too. The first of a connection is its own; those beside it share a number.
//
// Peers share the common room and that number by the rule of share.h.
//
// An image that has room needs nothing else in order to be sent and to give the room back, so nobody waits in a circle.
//
// For the front's one thread (loop.h). Nothing here fails.
#ifndef CANDIL_FRONT_JOBS_ROOM_H
#define CANDIL_FRONT_JOBS_ROOM_H

#include <stdbool.h>
#include <stdint.h>

// What is taken, by everybody in the daemon, by one peer or by one connection. Zeroed is nothing.
struct room {
	uint64_t own, common; // bytes
	unsigned images; // of a connection; of a peer and everybody those beside the first of each connection
};

// Whose room an image takes.
struct room_owner {
	struct room *all, *peer, *connection;
	unsigned most_images; // that all->images may be
};

enum room_kind { ROOM_NONE, ROOM_OWN, ROOM_COMMON };

// Where one image lies. Zeroed is nowhere.
struct room_place {
	enum room_kind kind;
	uint64_t bytes;
};

enum room_answer {
	ROOM_TAKEN,
	ROOM_CONNECTION_FULL, // until images of the same connection are gone
	ROOM_COMMON_FULL, // until images in the common room are gone, or some of those that share descriptors
	ROOM_SHARE_FULL, // likewise, of this peer; or others wait for the common room
};

// Take room for an image of `bytes`, whose `place` is nowhere so far. `own_only`: the common room is left to
// others who wait for it. Unless the answer is ROOM_TAKEN nothing has changed.
enum room_answer room_take(const struct room_owner *owner, struct room_place *place, uint64_t bytes, bool own_only);

// The image turned out to have another size than was thought. It stays where it is, even if it is too large for it now. One
// that is nowhere stays nowhere.
void room_resize(const struct room_owner *owner, struct room_place *place, uint64_t bytes);

// The image is gone, and its place is nowhere. Nothing for one that is nowhere already.
void room_give_back(const struct room_owner *owner, struct room_place *place);

// Bytes that are taken.
uint64_t room_bytes(const struct room *room);

#endif
