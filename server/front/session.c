#include "server/front/session.h"

#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>

#include "protocol/limits.h"
#include "server/base/clock.h"

// What one session may do in a turn of the loop, so that the others get their turn.
#define READS_PER_TURN 64u
#define FILLS_PER_TURN 4u
// A lingering session reads so much more and throws it away, so that the peer can finish what it is sending and then read
// its last replies.
#define DISCARD_BYTES (4u * LIMIT_MESSAGE_BYTES)

static void session_ready(void *owner, uint32_t events);

void sessions_init(struct sessions *sessions, struct loop *loop, const struct session_events *events, void *owner)
{
	*sessions = (struct sessions){.loop = loop, .events = events, .owner = owner, .next_id = 1};
}

static void session_destroy(struct session *session)
{
	loop_timer_stop(session->table->loop, &session->timer);
	session->channel.kind->close(&session->channel);
	reader_finish(&session->reader);
	outbox_finish(&session->outbox);
	peers_leave(&session->table->peers, session->peer);
	session->table->count--;
	session->table->turned_away -= session->turned_away;
	free(session);
}

void sessions_finish(struct sessions *sessions)
{
	while (sessions->first) {
		struct session *s = sessions->first;
		sessions->first = s->next;
		session_destroy(s);
	}
}

unsigned sessions_of(const struct sessions *sessions, uint64_t peer, bool turned_away)
{
	unsigned count = 0;
	for (const struct session *s = sessions->first; s; s = s->next)
		count += s->channel.peer == peer && s->turned_away == turned_away;
	return count;
}

static void say_ended(struct session *session)
{
	if (session->ended_said)
		return;
	session->ended_said = true;
	session->table->events->ended(session->table->owner, session);
}

static void session_die(struct session *session)
{
	say_ended(session);
	session->state = SESSION_DEAD;
}

static void refuse_peer(struct session *session, uint32_t request, const struct error *err)
{
	session->table->events->refused(session->table->owner, session, request, err);
	session_close(session);
}

static void session_time_out(void *owner)
{
	struct session *s = owner;
	struct error err;
	if (s->state != SESSION_GREETING) {
		session_die(s); // stalled, or lingered long enough
		return;
	}
	error_set(&err, STATUS_HELLO_FIRST, "no hello came within %u ms: say it first", LIMIT_HELLO_MS);
	refuse_peer(s, 0, &err);
}

static void set_timer(struct session *session, uint64_t ms)
{
	loop_timer_set(session->table->loop, &session->timer, clock_us() + ms * 1000, session_time_out, session);
}

enum status session_create(struct sessions *sessions, struct channel *channel, struct session **session, struct error *err)
{
	struct session *s = calloc(1, sizeof *s);
	enum status status = STATUS_MEMORY;
	if (!s) {
		error_set(err, status, "no memory for one more connection");
		goto out;
	}
	*s = (struct session){.id = sessions->next_id++, .channel = *channel, .table = sessions, .next = sessions->first};
	reader_init(&s->reader);
	s->peer = peers_join(&sessions->peers, channel->peer);
	if (!s->peer) {
		error_set(err, status, "no memory for one more connection");
		goto out;
	}
	status = s->channel.kind->watch(&s->channel, session_ready, s, err);
	if (status != STATUS_OK)
		goto out;
	set_timer(s, LIMIT_HELLO_MS);
	sessions->first = s;
	sessions->count++;
	*session = s;
	return STATUS_OK;
out:
	if (s && s->peer)
		peers_leave(&sessions->peers, s->peer);
	free(s);
	channel->kind->close(channel);
	return status;
}

void session_open(struct session *session)
{
	session->state = SESSION_OPEN;
	loop_timer_stop(session->table->loop, &session->timer);
}

void session_close(struct session *session)
{
	if (session->state >= SESSION_FLUSHING)
		return;
	say_ended(session);
	session->state = SESSION_FLUSHING;
	set_timer(session, LIMIT_LINGER_MS);
}

uint8_t *session_room(struct session *session, uint32_t bytes)
{
	if (session->state >= SESSION_LINGERING)
		return NULL;
	uint8_t *room = outbox_room(&session->outbox, CANDIL_HEADER_BYTES + (size_t)bytes);
	if (!room) {
		// The caller is likely to be the owner in the middle of a job of this session, so `ended`, which frees its
		// jobs, must wait for sessions_sweep.
		session->state = SESSION_DEAD;
		return NULL;
	}
	return room + CANDIL_HEADER_BYTES;
}

void session_commit(struct session *session, uint8_t type, uint32_t request, uint32_t bytes)
{
	struct header header = {.version = CANDIL_VERSION, .type = type, .length = bytes, .request = request};
	uint8_t *room = outbox_room(&session->outbox, CANDIL_HEADER_BYTES + (size_t)bytes);
	if (!room)
		return;
	header_encode(&header, room);
	outbox_commit(&session->outbox, CANDIL_HEADER_BYTES + (size_t)bytes);
	// From now on bytes wait: the peer must take some of them in time.
	if (session->state == SESSION_OPEN && !session->timer.running)
		set_timer(session, LIMIT_STALL_SECONDS * 1000ull);
}

void session_send(struct session *session, uint8_t type, uint32_t request, const void *body, uint32_t bytes)
{
	uint8_t *room = session_room(session, bytes);
	if (!room)
		return;
	if (bytes > 0)
		memcpy(room, body, bytes);
	session_commit(session, type, request, bytes);
}

bool session_has_room(const struct session *session, size_t bytes)
{
	return session->state == SESSION_OPEN &&
	       session->outbox.length + CANDIL_HEADER_BYTES + bytes <= LIMIT_OUT_BUFFER_BYTES;
}

static bool is_read(const struct session *session)
{
	return session->state == SESSION_GREETING ||
	       (session->state == SESSION_OPEN && session->outbox.length <= LIMIT_OUT_BUFFER_BYTES);
}

static void refuse_stream(struct session *session, enum status status)
{
	struct error err;
	const char *what = status == STATUS_BAD_MAGIC          ? "these bytes are no header of ours: speak the protocol"
			   : status == STATUS_BAD_VERSION      ? "the header's version is none that this daemon speaks"
			   : status == STATUS_BAD_FLAGS        ? "the header has a flag that is not defined"
			   : status == STATUS_MESSAGE_TOO_LONG ? "the message is longer than the hello's reply allows"
							       : "no memory for the message";
	error_set(&err, status, "%s", what);
	// In bytes that are no header of ours there is no request id that could be trusted.
	refuse_peer(session, status == STATUS_BAD_MAGIC ? 0 : session->reader.header.request, &err);
}

static void take_bytes(struct session *session, size_t bytes, const struct channel_fds *fds)
{
	bool complete;
	for (unsigned i = 0; i < fds->count; i++)
		reader_take_fd(&session->reader, fds->fd[i]);
	enum status status = reader_take(&session->reader, bytes, &complete);
	if (status != STATUS_OK) {
		refuse_stream(session, status);
	} else if (complete) {
		session->table->events->message(session->table->owner, session, &session->reader.header,
						session->reader.body);
		reader_next(&session->reader);
	}
}

static void read_some(struct session *session)
{
	for (unsigned i = 0; i < READS_PER_TURN && is_read(session); i++) {
		struct channel_fds fds;
		size_t space, bytes;
		uint8_t *to = reader_space(&session->reader, &space);
		switch (session->channel.kind->read(&session->channel, to, space, &bytes, &fds)) {
		case CHANNEL_DONE:
			take_bytes(session, bytes, &fds);
			break;
		case CHANNEL_LATER:
			return;
		case CHANNEL_ENDED:
			session_close(session);
			break;
		case CHANNEL_BROKEN:
			session_die(session);
			break;
		}
	}
}

static void session_discard(struct session *session)
{
	uint8_t waste[4096];
	size_t bytes = 0;
	enum channel_result result = session->channel.kind->read(&session->channel, waste, sizeof waste, &bytes, NULL);
	if (result == CHANNEL_DONE)
		session->discarded += bytes;
	if (result == CHANNEL_ENDED || result == CHANNEL_BROKEN || session->discarded > DISCARD_BYTES)
		session_die(session);
}

static void session_ready(void *owner, uint32_t events)
{
	struct session *s = owner;
	if (events & EPOLLOUT)
		s->blocked = false;
	if (s->state == SESSION_LINGERING)
		session_discard(s);
	else if (is_read(s) && (events & (EPOLLIN | EPOLLHUP | EPOLLERR)))
		read_some(s);
	else if (events & (EPOLLHUP | EPOLLERR))
		session_die(s);
}

static void send_once(struct session *session)
{
	size_t written;
	switch (session->channel.kind->write(&session->channel, session->outbox.memory + session->outbox.start,
					     session->outbox.length, &written)) {
	case CHANNEL_DONE:
		outbox_drop(&session->outbox, written);
		if (session->state == SESSION_OPEN)
			loop_timer_stop(session->table->loop, &session->timer);
		break;
	case CHANNEL_LATER:
		session->blocked = true;
		break;
	default:
		session_die(session);
		break;
	}
}

static void send_some(struct session *session)
{
	while (session->outbox.length > 0 && !session->blocked && session->state != SESSION_DEAD)
		send_once(session);
	if (session->state == SESSION_OPEN && session->outbox.length > 0 && !session->timer.running)
		set_timer(session, LIMIT_STALL_SECONDS * 1000ull);
	if (session->state == SESSION_FLUSHING && session->outbox.length == 0) {
		session->channel.kind->end(&session->channel);
		session->state = SESSION_LINGERING;
	}
	if (session->curt)
		session_die(session);
}

bool sessions_flush(struct sessions *sessions)
{
	bool filled_any = false;
	for (struct session *s = sessions->first; s; s = s->next) {
		send_some(s);
		for (unsigned i = 0; i < FILLS_PER_TURN && s->state == SESSION_OPEN && !s->blocked; i++) {
			if (!sessions->events->fill(sessions->owner, s))
				break;
			filled_any = true;
			send_some(s);
		}
	}
	return filled_any;
}

static uint32_t wanted(const struct session *session)
{
	uint32_t events = 0;
	if (is_read(session) || session->state == SESSION_LINGERING)
		events |= EPOLLIN;
	if (session->outbox.length > 0)
		events |= EPOLLOUT;
	return events;
}

void sessions_sweep(struct sessions *sessions)
{
	for (struct session *s = sessions->first; s; s = s->next)
		if (s->state == SESSION_DEAD)
			say_ended(s);
	for (struct session **link = &sessions->first; *link;) {
		struct session *s = *link;
		if (s->state == SESSION_DEAD) {
			*link = s->next;
			session_destroy(s);
			continue;
		}
		s->channel.kind->want(&s->channel, wanted(s));
		link = &s->next;
	}
}

uint64_t sessions_buffered(const struct sessions *sessions)
{
	uint64_t bytes = 0;
	for (const struct session *s = sessions->first; s; s = s->next)
		bytes += s->outbox.length;
	return bytes;
}
