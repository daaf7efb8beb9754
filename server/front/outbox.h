// Bytes that wait for a connection to take them: a queue in one piece of memory. For the front's one thread (loop.h).
#ifndef CANDIL_FRONT_OUTBOX_H
#define CANDIL_FRONT_OUTBOX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Zeroed is empty.
struct outbox {
	uint8_t *memory;
	size_t capacity;
	size_t start; // of the bytes that wait
	size_t length; // of them
};

void outbox_finish(struct outbox *outbox);

// Room for `bytes` more behind the last, good until the next call; NULL without memory. The caller writes them, and
// outbox_commit puts them into the queue.
uint8_t *outbox_room(struct outbox *outbox, size_t bytes);
void outbox_commit(struct outbox *outbox, size_t bytes);

// Copy `bytes` in. False without memory; nothing is queued then.
bool outbox_append(struct outbox *outbox, const void *data, size_t bytes);

// The first `bytes` were taken. An empty box gives its memory back.
void outbox_drop(struct outbox *outbox, size_t bytes);

#endif
