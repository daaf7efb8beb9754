// From a stream of bytes to messages. Takes bytes in pieces of any size, one at a time included; allocates a body only after
// its header passed the limits. Knows nothing of sockets: the session asks where the next bytes go.
#ifndef CANDIL_FRONT_READER_H
#define CANDIL_FRONT_READER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "protocol/header.h"

struct reader {
	uint8_t head[CANDIL_HEADER_BYTES];
	size_t have; // bytes of the header, then of the body
	struct header header;
	bool in_body;
	uint8_t *body; // header.length bytes; NULL if there are none
	int fd; // came with the header; -1: none
};

void reader_init(struct reader *reader);
void reader_finish(struct reader *reader);

// Where the next bytes go, and how many at most (never 0 between reader_next and a complete message).
uint8_t *reader_space(struct reader *reader, size_t *bytes);

// A descriptor came with bytes that are about to be taken. It is kept if they are of the header and none was kept yet; else
// it is closed, for nobody expects it. (The first byte alone is no rule that could be held to: the kernel gives a descriptor
// with whichever read takes bytes of the message that carried it.)
void reader_take_fd(struct reader *reader, int fd);

// `bytes` were written to reader_space(). *complete: header and body are there. Any status but OK is header_decode's, or
// STATUS_MEMORY: the stream cannot be read on. reader->header is then as far filled as header_decode says.
enum status reader_take(struct reader *reader, size_t bytes, bool *complete);

// Hand over the descriptor; -1 if none.
int reader_claim_fd(struct reader *reader);

// Forget the message (its body and an unclaimed descriptor too) and begin the next.
void reader_next(struct reader *reader);

#endif
