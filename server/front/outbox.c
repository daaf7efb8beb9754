#include "server/front/outbox.h"

#include <stdlib.h>
#include <string.h>

#include "server/base/checked.h"

#define LEAST_CAPACITY 4096u

void outbox_finish(struct outbox *outbox)
{
	free(outbox->memory);
	*outbox = (struct outbox){0};
}

static void move_to_front(struct outbox *outbox)
{
	if (outbox->start > 0)
		memmove(outbox->memory, outbox->memory + outbox->start, outbox->length);
	outbox->start = 0;
}

uint8_t *outbox_room(struct outbox *outbox, size_t bytes)
{
	size_t wanted;
	if (!checked_add(outbox->length, bytes, &wanted))
		return NULL;
	if (outbox->capacity - outbox->start < wanted && outbox->memory)
		move_to_front(outbox);
	if (outbox->capacity < wanted) {
		size_t capacity = outbox->capacity ? outbox->capacity : LEAST_CAPACITY;
		while (capacity < wanted)
			if (!checked_mul(capacity, 2, &capacity))
				return NULL;
		uint8_t *grown = realloc(outbox->memory, capacity);
		if (!grown)
			return NULL;
		outbox->memory = grown;
		outbox->capacity = capacity;
	}
	return outbox->memory + outbox->start + outbox->length;
}

void outbox_commit(struct outbox *outbox, size_t bytes)
{
	outbox->length += bytes;
}

bool outbox_append(struct outbox *outbox, const void *data, size_t bytes)
{
	uint8_t *room = outbox_room(outbox, bytes);
	if (!room)
		return false;
	if (bytes > 0)
		memcpy(room, data, bytes);
	outbox_commit(outbox, bytes);
	return true;
}

void outbox_drop(struct outbox *outbox, size_t bytes)
{
	outbox->start += bytes;
	outbox->length -= bytes;
	if (outbox->length == 0)
		outbox_finish(outbox);
}
