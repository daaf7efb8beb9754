#include "server/front/parcels.h"

#include <stdlib.h>
#include <string.h>

#include "protocol/limits.h"
#include "server/base/ipc.h"

static void parcels_drop(struct parcels *parcels, struct parcel **link)
{
	struct parcel *p = *link;
	*link = p->next;
	if (parcels->last == p) {
		parcels->last = NULL;
		for (struct parcel *q = parcels->first; q; q = q->next)
			parcels->last = q;
	}
	parcels->count--;
	free(p);
}

void parcels_drop_first(struct parcels *parcels)
{
	parcels_drop(parcels, &parcels->first);
}

void parcels_clear(struct parcels *parcels)
{
	while (parcels->first)
		parcels_drop(parcels, &parcels->first);
}

const char *parcels_keep(struct parcels *parcels, const void *message, size_t bytes, int fd)
{
	struct parcel *p = parcels->count < LIMIT_IPC_QUEUE ? malloc(sizeof *p + bytes) : NULL;
	if (!p)
		return "it took no more messages";
	*p = (struct parcel){.fd = fd, .bytes = bytes};
	memcpy(p->message, message, bytes);
	if (parcels->last)
		parcels->last->next = p;
	else
		parcels->first = p;
	parcels->last = p;
	parcels->count++;
	return NULL;
}

bool parcels_take_back(struct parcels *parcels, uint64_t scene)
{
	for (struct parcel **link = &parcels->first; *link; link = &(*link)->next) {
		struct ipc_scene message;
		if ((*link)->bytes != sizeof message)
			continue;
		memcpy(&message, (*link)->message, sizeof message);
		if (message.head.op == IPC_SCENE && message.scene == scene) {
			parcels_drop(parcels, link);
			return true;
		}
	}
	return false;
}
