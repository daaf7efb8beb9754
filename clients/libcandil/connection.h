// One connection: its socket, what has arrived, what waits to be sent, and why it is over. It knows messages by their
// headers alone; requests and replies are built on top of it.
//
// What arrives stays in one fixed buffer until connection_next takes it apart. A daemon that talks more than its client
// listens fills that buffer and then its own socket, so nothing here grows.
//
// A connection belongs to one thread at a time.
#ifndef CANDIL_LIBCANDIL_CONNECTION_H
#define CANDIL_LIBCANDIL_CONNECTION_H

#include "clients/libcandil/candil.h"
#include "protocol/header.h"
#include "protocol/limits.h"

#define CONNECTION_IN_BYTES (4u * (CANDIL_HEADER_BYTES + LIMIT_MESSAGE_BYTES))
#define CONNECTION_OUT_BYTES (1024u * 1024u) // of unsent requests, at most
#define CONNECTION_OUT_FDS 16u // unsent descriptors, at most

struct connection {
	int fd; // the connection's own; closed by connection_finish

	uint8_t in[CONNECTION_IN_BYTES];
	size_t in_start, in_end; // what has arrived and was not taken
	bool eof; // nothing more will arrive

	uint8_t *out;
	size_t out_start, out_end, out_capacity;
	struct {
		size_t at; // goes along with the byte at this place of `out`
		int fd; // the connection's own until it is sent
	} out_fds[CONNECTION_OUT_FDS];
	uint32_t out_fd_count;

	struct candil_error broken; // why the connection is over; code OK while it is not
};

// Begin with a connected stream socket, which is the connection's from now on. `connection` must be all zero.
void connection_init(struct connection *connection, int fd);

// Close every descriptor and free the buffers; what was not sent is dropped.
void connection_finish(struct connection *connection);

// End the connection for this reason, unless it is over already.
void connection_break(struct connection *connection, candil_status code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

// CANDIL_STATUS_OK while the connection lives; else why it is over, in `error` too, which may be NULL.
candil_status connection_status(const struct connection *connection, struct candil_error *error);

// Append to the unsent bytes. `fd` (-1: none) goes along with the first of them and is the connection's own on success.
// Fails with LIMIT (too much is unsent), MEMORY, or why the connection is over.
candil_status connection_queue(struct connection *connection, const void *bytes, size_t count, int fd,
			       struct candil_error *error);

// Whether bytes are waiting to be sent.
bool connection_wants_write(const struct connection *connection);

// Send and receive what can be without waiting.
void connection_exchange(struct connection *connection);

// Wait until something can be sent or received; after `timeout_ms` (-1: never) without that the connection breaks with IO.
void connection_wait(struct connection *connection, int timeout_ms);

// Take one whole message off what has arrived. *body points into the connection until the next call of any function here.
// false: none is there. A header that is none of ours breaks the connection, and so does the end of the stream once every
// whole message has been taken.
bool connection_next(struct connection *connection, struct header *header, const uint8_t **body);

#endif
