// A connection: its bytes in, its bytes out, its life. A session knows messages by their headers only. What they say, and
// what is answered, is its owner's affair.
//
// Backpressure: while more than LIMIT_OUT_BUFFER_BYTES wait to be taken, the session is not read and gets no frame chunks.
// One that takes no byte for LIMIT_STALL_SECONDS while some wait is dead. After an error on the stream the peer is refused:
// nothing more is read, and once everything is taken (or LIMIT_LINGER_MS after) the session is closed.
//
// All functions and calls are for the front's one thread (loop.h). Sessions are freed in sessions_sweep and sessions_finish
// alone, so no call finds its own session freed by what it did.
#ifndef CANDIL_FRONT_SESSION_H
#define CANDIL_FRONT_SESSION_H

#include <stdbool.h>
#include <stdint.h>

#include "server/front/channel.h"
#include "server/front/jobs/room.h"
#include "server/front/loop.h"
#include "server/front/outbox.h"
#include "server/front/peer.h"
#include "server/front/reader.h"

enum session_state {
	SESSION_GREETING, // no hello yet
	SESSION_OPEN,
	SESSION_FLUSHING, // nothing is read any more; what waits is sent
	SESSION_LINGERING, // all is sent; the peer may read it before the channel is closed
	SESSION_DEAD, // freed by the next sessions_sweep
};

struct session;

// Calls from a session to the owner of all sessions. None may be NULL.
struct session_events {
	// A whole message has come. `header` and `body` (header->length bytes; NULL for none) are the session's and good for
	// the length of the call. A descriptor that came along may be claimed from session->reader; else it is closed after
	// the call.
	void (*message)(void *owner, struct session *session, const struct header *header, const uint8_t *body);

	// There is room for chunks: queue some. True if some were queued.
	bool (*fill)(void *owner, struct session *session);

	// What the peer sent is no stream of messages, or no hello came in time: send it `err` under the id `request`. The
	// session closes itself after the call.
	void (*refused)(void *owner, struct session *session, uint32_t request, const struct error *err);

	// Nothing more is read from it, and its requests end here. Once a session.
	void (*ended)(void *owner, struct session *session);
};

// Others may read `id`, `peer`, `state`, `outbox`, claim from `reader`, set `turned_away` and `curt`, and keep `requests`
// and `room`.
struct session {
	uint64_t id; // for the log
	struct channel channel;
	struct peer *peer;
	enum session_state state;
	bool ended_said;
	bool blocked; // the channel took no more
	bool turned_away; // it is told why, and nothing else: set by its owner
	bool curt; // likewise: what waits is sent once, and nobody waits for the peer to read it
	struct reader reader;
	struct outbox outbox;
	size_t discarded; // bytes thrown away while lingering
	unsigned requests; // renders, sweeps and loads under way: kept by those who run them
	struct room room; // taken by its images: kept by jobs
	struct loop_timer timer; // for the hello, for a stall, for lingering
	struct sessions *table;
	struct session *next;
};

// Others may read `first` and `count`.
struct sessions {
	struct loop *loop;
	const struct session_events *events;
	void *owner;
	struct session *first;
	struct peer *peers;
	unsigned count;
	unsigned turned_away; // of these: counted up by their owner
	uint64_t next_id;
};

// No session yet. `loop`, `events` and `owner` must outlive it.
void sessions_init(struct sessions *sessions, struct loop *loop, const struct session_events *events, void *owner);

// How many sessions a peer has, of those that are turned away or of the others.
unsigned sessions_of(const struct sessions *sessions, uint64_t peer, bool turned_away);

// Close and free all sessions at once. No call is made.
void sessions_finish(struct sessions *sessions);

// Make a session of a channel, which is taken over (closed on failure too). It must say hello within LIMIT_HELLO_MS. The
// session is the table's; *session is good until it is SESSION_DEAD. Failures: STATUS_MEMORY, STATUS_INTERNAL.
enum status session_create(struct sessions *sessions, struct channel *channel, struct session **session, struct error *err);

// The hello was good: the session is SESSION_OPEN, and silence is allowed.
void session_open(struct session *session);

// Read no more, end its requests (`ended`), and close when all that waits is sent. Nothing on a session that is closing.
void session_close(struct session *session);

// Queue a message: `body` of `bytes` ≥ 0 bytes, which is copied, behind a header. Without memory the session dies, and a
// dead session takes nothing; the caller need not know.
void session_send(struct session *session, uint8_t type, uint32_t request, const void *body, uint32_t bytes);

// Room for the body of a message of `bytes`, for the caller to write and then to queue by session_commit with the same
// `bytes`, before anything else is queued. NULL if the session is dead, or dies for want of memory.
uint8_t *session_room(struct session *session, uint32_t bytes);
void session_commit(struct session *session, uint8_t type, uint32_t request, uint32_t bytes);

// May a body of `bytes` be queued without passing LIMIT_OUT_BUFFER_BYTES? False unless the session is SESSION_OPEN. Replies
// need not ask; chunks and progress do.
bool session_has_room(const struct session *session, size_t bytes);

// Send what the channels take, and let the owner fill up. True if some call of `fill` queued something.
bool sessions_flush(struct sessions *sessions);

// Free the dead, whose `ended` is called first if it has not been, and set what is waited for on the others. The only place
// where a session goes while the loop runs.
void sessions_sweep(struct sessions *sessions);

// Bytes that wait to be taken, of all sessions together.
uint64_t sessions_buffered(const struct sessions *sessions);

#endif
