// A connection: its bytes in, its bytes out, its life. Knows messages by header only; what they say is its owner's affair.
//
// Backpressure: while more than LIMIT_OUT_BUFFER_BYTES wait to be taken, the connection is not read and gets no frame
// chunks. Errors on the stream: an answer, then no more reading; once everything is taken (or LIMIT_LINGER_MS after) it is
// closed.
#ifndef CANDIL_FRONT_SESSION_H
#define CANDIL_FRONT_SESSION_H

#include <stdbool.h>
#include <stdint.h>

#include "server/front/jobs/room.h"
#include "server/front/loop.h"
#include "server/front/outbox.h"
#include "server/front/reader.h"

enum session_state {
	SESSION_GREETING, // no hello yet
	SESSION_OPEN,
	SESSION_FLUSHING, // nothing is read any more; what waits is sent
	SESSION_LINGERING, // all is sent; the peer may read it before we close
	SESSION_DEAD, // freed by the next settle
};

struct session;

// Calls from a session to its owner.
struct session_events {
	// A whole message. `body` has header->length bytes; a descriptor may be claimed from session->reader.
	void (*message)(void *owner, struct session *session, const struct header *header, const uint8_t *body);
	// There is room for chunks. True if some were queued.
	bool (*fill)(void *owner, struct session *session);
	// What the peer sent is no stream of messages, or no hello came in time: send it `err` under the id `request`. The
	// session closes itself after the call.
	void (*refused)(void *owner, struct session *session, uint32_t request, const struct error *err);
	// Nothing more is read from it; its requests end here. Once a session.
	void (*ended)(void *owner, struct session *session);
};

struct session {
	uint64_t id; // for the log
	int fd;
	enum session_state state;
	bool ended_said;
	bool blocked; // the socket took no more
	struct reader reader;
	struct outbox outbox;
	size_t discarded; // bytes thrown away while lingering
	unsigned requests; // renders and loads under way: kept by those who run them
	struct room room; // of images that wait for it: kept by jobs
	struct loop_timer timer;
	struct sessions *table;
	struct session *next;
};

struct sessions {
	struct loop *loop;
	const struct session_events *events;
	void *owner;
	struct session *first;
	unsigned count;
	uint64_t next_id;
};

void sessions_init(struct sessions *sessions, struct loop *loop, const struct session_events *events, void *owner);
void sessions_finish(struct sessions *sessions);

// Take over a connected stream socket (closed on failure too). It must say hello within LIMIT_HELLO_MS.
enum status session_create(struct sessions *sessions, int fd, struct session **session, struct error *err);

// The hello was good.
void session_open(struct session *session);

// Read no more; close when all that waits is sent.
void session_close(struct session *session);

// Queue a message. Without memory the session dies; a dead one takes nothing.
void session_send(struct session *session, uint8_t type, uint32_t request, const void *body, uint32_t bytes);

// Room for a message of `bytes`, to be written by the caller and then sent by session_commit; NULL if it is dead or
// without memory.
uint8_t *session_room(struct session *session, uint32_t bytes);
void session_commit(struct session *session, uint8_t type, uint32_t request, uint32_t bytes);

// May a body of `bytes` be queued without passing the limit?
bool session_has_room(const struct session *session, size_t bytes);

// Send what can be sent, let the owner fill up. True if some call of `fill` queued something.
bool sessions_flush(struct sessions *sessions);

// Free the dead, set what is waited for on the others.
void sessions_sweep(struct sessions *sessions);

uint64_t sessions_buffered(const struct sessions *sessions);

#endif
