// A session without memory: its owner, who may be in the middle of one of its jobs, learns of the end from the sweep alone.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka wants the four above first
#include <cmocka.h>
#include <sys/socket.h>
#include <unistd.h>

#include "protocol/header.h"
#include "server/front/session.h"

static unsigned ended;
static bool filled;

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
	(void)owner, (void)session, (void)request, (void)err;
}

static void on_ended(void *owner, struct session *session)
{
	(void)owner, (void)session;
	ended++;
}

static void a_session_without_memory_ends_in_the_sweep(void **state)
{
	static const struct session_events events = {
	    .message = on_message, .fill = on_fill, .refused = on_refused, .ended = on_ended};
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

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(a_session_without_memory_ends_in_the_sweep)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
