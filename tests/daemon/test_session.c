// Sessions beneath their owner and above their channel. One without memory: its owner, who may be in the middle of one of
// its jobs, learns of the end from the sweep alone. One over a channel without any descriptor: it speaks through the table.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka wants the four above first
#include <cmocka.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "protocol/header.h"
#include "server/front/session.h"

static unsigned ended;
static bool filled;
static enum status refused;
static uint32_t refused_request;

uint8_t *__wrap_outbox_room(struct outbox *outbox, size_t bytes);

uint8_t *__wrap_outbox_room(struct outbox *outbox, size_t bytes)
{
	(void)outbox, (void)bytes;
	return NULL;
}

static void on_message(void *owner, struct session *session, const struct header *header, const uint8_t *body)
{
	(void)owner, (void)session, (void)header, (void)body;
}

static bool on_fill(void *owner, struct session *session)
{
	(void)owner;
	session_send(session, MESSAGE_PONG, 1, NULL, 0);
	assert_int_equal(ended, 0);
	filled = true;
	return false;
}

static void on_refused(void *owner, struct session *session, uint32_t request, const struct error *err)
{
	(void)owner, (void)session;
	refused = err->code;
	refused_request = request;
}

static void on_ended(void *owner, struct session *session)
{
	(void)owner, (void)session;
	ended++;
}

static const struct session_events events = {
    .message = on_message, .fill = on_fill, .refused = on_refused, .ended = on_ended};

static void a_session_without_memory_ends_in_the_sweep(void **state)
{
	struct sessions sessions;
	struct session *session;
	struct channel channel;
	struct loop *loop;
	int pair[2];
	(void)state;
	assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair), 0);
	assert_int_equal(loop_create(&loop, NULL), STATUS_OK);
	sessions_init(&sessions, loop, &events, NULL);
	assert_int_equal(channel_unix_adopt(&channel, loop, pair[0], NULL), STATUS_OK);
	assert_int_equal(session_create(&sessions, &channel, &session, NULL), STATUS_OK);
	session_open(session);
	sessions_flush(&sessions);
	assert_true(filled);
	assert_int_equal(ended, 0);
	assert_int_equal(sessions.count, 1);
	sessions_sweep(&sessions);
	assert_int_equal(ended, 1);
	assert_int_equal(sessions.count, 0);
	sessions_finish(&sessions);
	loop_destroy(loop);
	close(pair[1]);
}

// A channel of bytes in memory.
static struct {
	loop_ready *ready;
	void *owner;
	const char *says; // what is left to read; then it ends
	uint32_t wanted;
	unsigned ends, closes;
} peer;

static enum status memory_watch(struct channel *channel, loop_ready *ready, void *owner, struct error *err)
{
	(void)channel, (void)err;
	peer.ready = ready;
	peer.owner = owner;
	return STATUS_OK;
}

static void memory_want(struct channel *channel, uint32_t wanted)
{
	(void)channel;
	peer.wanted = wanted;
}

static enum channel_result memory_read(struct channel *channel, void *buffer, size_t room, size_t *bytes,
				       struct channel_fds *fds)
{
	size_t length = strlen(peer.says);
	(void)channel;
	if (fds)
		fds->count = 0;
	if (length == 0)
		return CHANNEL_ENDED;
	*bytes = length < room ? length : room;
	memcpy(buffer, peer.says, *bytes);
	peer.says += *bytes;
	return CHANNEL_DONE;
}

static enum channel_result memory_write(struct channel *channel, const void *data, size_t bytes, size_t *written)
{
	(void)channel, (void)data;
	*written = bytes;
	return CHANNEL_DONE;
}

static void memory_end(struct channel *channel)
{
	(void)channel;
	peer.ends++;
}

static bool memory_peer_allowed(const struct channel *channel)
{
	(void)channel;
	return true;
}

static void memory_close(struct channel *channel)
{
	(void)channel;
	peer.closes++;
}

static void a_session_speaks_through_its_channel_alone(void **state)
{
	static const struct channel_kind kind = {.watch = memory_watch,
						 .want = memory_want,
						 .read = memory_read,
						 .write = memory_write,
						 .end = memory_end,
						 .peer_allowed = memory_peer_allowed,
						 .close = memory_close};
	struct channel channel = {.kind = &kind, .fd = -1};
	struct sessions sessions;
	struct session *session;
	struct loop *loop;
	(void)state;
	ended = 0;
	peer.says = "no header of ours";
	assert_int_equal(loop_create(&loop, NULL), STATUS_OK);
	sessions_init(&sessions, loop, &events, NULL);
	assert_int_equal(session_create(&sessions, &channel, &session, NULL), STATUS_OK);
	sessions_sweep(&sessions);
	assert_int_equal(peer.wanted, EPOLLIN);

	// Refused: the owner is told what to send, and nothing more is read.
	peer.ready(peer.owner, EPOLLIN);
	assert_int_equal(refused, STATUS_BAD_MAGIC);
	assert_int_equal(refused_request, 0);
	assert_int_equal(ended, 1);
	assert_int_equal(session->state, SESSION_FLUSHING);
	sessions_flush(&sessions);
	assert_int_equal(peer.ends, 1);
	assert_int_equal(session->state, SESSION_LINGERING);

	// It lingers until the peer has nothing more to say.
	while (session->state == SESSION_LINGERING)
		peer.ready(peer.owner, EPOLLIN);
	assert_int_equal(peer.closes, 0);
	sessions_sweep(&sessions);
	assert_int_equal(peer.closes, 1);
	assert_int_equal(sessions.count, 0);
	assert_int_equal(ended, 1);
	sessions_finish(&sessions);
	loop_destroy(loop);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_session_without_memory_ends_in_the_sweep),
	    cmocka_unit_test(a_session_speaks_through_its_channel_alone),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
