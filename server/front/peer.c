#include "server/front/peer.h"

#include <stdlib.h>

struct peer *peers_join(struct peer **peers, uint64_t id)
{
	struct peer *peer = *peers;
	while (peer && peer->id != id)
		peer = peer->next;
	if (!peer) {
		peer = calloc(1, sizeof *peer);
		if (!peer)
			return NULL;
		*peer = (struct peer){.id = id, .next = *peers};
		*peers = peer;
	}
	peer->sessions++;
	return peer;
}

void peers_leave(struct peer **peers, struct peer *peer)
{
	if (--peer->sessions > 0)
		return;
	while (*peers != peer)
		peers = &(*peers)->next;
	*peers = peer->next;
	free(peer);
}
