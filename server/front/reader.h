// From a stream of bytes to messages. A reader takes bytes in pieces of any size, even one by one, and allocates a body only
// after its header has passed the limits. It knows nothing of channels: the session asks where the next bytes go.
//
// For the front's one thread (loop.h).
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

// A descriptor came with bytes that are about to be taken, and is taken over. It is kept if the bytes are of the header and
// none was kept yet; else it is closed, for nobody expects it. (It need not come with the first byte: the kernel hands it to
// the read that takes any of the bytes it was sent with.)
void reader_take_fd(struct reader *reader, int fd);

// `bytes` were written where reader_space said. *complete: header and body are there. Failures, after which the stream
// cannot be read on: those of header_decode, with reader->header filled as far as that says, and STATUS_MEMORY.
enum status reader_take(struct reader *reader, size_t bytes, bool *complete);

// Hand the descriptor over to the caller; -1 if there is none.
int reader_claim_fd(struct reader *reader);

// Forget the message (its body and an unclaimed descriptor too) and begin the next.
void reader_next(struct reader *reader);

#endif
