// Who asks: all connections of one process. What everybody shares is shared between peers, whatever number of connections
// each of them has.
//
// Places that all share (connections, jobs, quotes, room for images) go by one rule: a peer may take what leaves it no more
// than LIMIT_SHARE times what is then free, and one that has none may have the last. So a peer alone has three quarters, two
// have three sevenths each, and whoever comes finds some left.
//
// For the front's one thread (loop.h).
#ifndef CANDIL_FRONT_PEER_H
#define CANDIL_FRONT_PEER_H

#include <stdbool.h>
#include <stdint.h>

#include "server/front/jobs/room.h"
#include "server/front/jobs/schedule.h"

// Kept by the sessions that it has, and goes with the last of them. All that stands behind `sessions` is kept by jobs.
struct peer {
	uint64_t id; // struct channel's
	struct peer *next;
	unsigned sessions;
	unsigned jobs;
	unsigned on_device; // jobs, at the last look
	struct room room; // taken by its images
	bool short_of_room; // an image waits for room that only its own images can give back
	struct peer_turn turn;
};

// The peer of a new session, in a list. NULL: no memory.
struct peer *peers_join(struct peer **peers, uint64_t id);

// One of its sessions ends.
void peers_leave(struct peer **peers, struct peer *peer);

#endif
