// The reader takes any cut of the stream and keeps no descriptor that nobody announced.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include "protocol/limits.h"
#include "server/front/reader.h"

static size_t message(uint8_t *out, const char *body)
{
	struct header h = {.version = CANDIL_VERSION, .type = MESSAGE_PING, .length = (uint32_t)strlen(body), .request = 7};
	header_encode(&h, out);
	memcpy(out + CANDIL_HEADER_BYTES, body, strlen(body));
	return CANDIL_HEADER_BYTES + strlen(body);
}

// Give the reader at most `piece` bytes. The bytes it took.
static size_t give(struct reader *reader, const uint8_t *bytes, size_t piece, bool *complete)
{
	size_t space;
	uint8_t *to = reader_space(reader, &space);
	assert_true(space > 0);
	size_t count = piece < space ? piece : space;
	memcpy(to, bytes, count);
	assert_int_equal(reader_take(reader, count, complete), STATUS_OK);
	return count;
}

static void every_cut_gives_the_same_messages(void **state)
{
	uint8_t stream[128];
	size_t length = message(stream, "first");
	length += message(stream + length, "");
	length += message(stream + length, "a third one");
	(void)state;
	for (size_t piece = 1; piece <= length; piece++) {
		static const char *const bodies[] = {"first", "", "a third one"};
		struct reader reader;
		unsigned seen = 0;
		reader_init(&reader);
		for (size_t at = 0; at < length;) {
			bool complete;
			at += give(&reader, stream + at, piece < length - at ? piece : length - at, &complete);
			if (!complete)
				continue;
			assert_true(seen < 3);
			assert_int_equal(reader.header.length, strlen(bodies[seen]));
			assert_int_equal(reader.header.request, 7);
			if (reader.header.length > 0)
				assert_memory_equal(reader.body, bodies[seen], strlen(bodies[seen]));
			seen++;
			reader_next(&reader);
		}
		assert_int_equal(seen, 3);
		reader_finish(&reader);
	}
}

static enum status judge(size_t at, uint8_t value)
{
	struct reader reader;
	uint8_t bytes[64];
	bool complete;
	size_t space;
	message(bytes, "");
	bytes[at] = value;
	reader_init(&reader);
	memcpy(reader_space(&reader, &space), bytes, CANDIL_HEADER_BYTES);
	enum status status = reader_take(&reader, CANDIL_HEADER_BYTES, &complete);
	reader_finish(&reader);
	return status;
}

static void wrong_headers_are_named(void **state)
{
	(void)state;
	for (size_t i = 0; i < 4; i++)
		assert_int_equal(judge(i, 0), STATUS_BAD_MAGIC);
	assert_int_equal(judge(4, 0), STATUS_BAD_VERSION);
	assert_int_equal(judge(4, CANDIL_VERSION + 1), STATUS_BAD_VERSION);
	assert_int_equal(judge(6, 2), STATUS_BAD_FLAGS);
	assert_int_equal(judge(7, 0x80), STATUS_BAD_FLAGS);
	assert_int_equal(judge(11, 0x80), STATUS_MESSAGE_TOO_LONG);
	assert_int_equal(judge(5, 0x55), STATUS_OK); // an unknown type is not the reader's affair
}

static void the_limit_itself_is_allowed(void **state)
{
	struct header h = {.version = CANDIL_VERSION, .type = MESSAGE_PING, .length = LIMIT_MESSAGE_BYTES};
	struct reader reader;
	bool complete;
	size_t space;
	(void)state;
	reader_init(&reader);
	header_encode(&h, reader_space(&reader, &space));
	assert_int_equal(reader_take(&reader, CANDIL_HEADER_BYTES, &complete), STATUS_OK);
	reader_space(&reader, &space);
	assert_int_equal(space, LIMIT_MESSAGE_BYTES);
	reader_finish(&reader);
	h.length++;
	reader_init(&reader);
	header_encode(&h, reader_space(&reader, &space));
	assert_int_equal(reader_take(&reader, CANDIL_HEADER_BYTES, &complete), STATUS_MESSAGE_TOO_LONG);
	reader_finish(&reader);
}

static bool is_open(int fd)
{
	return fcntl(fd, F_GETFD) >= 0;
}

static int some_fd(void)
{
	int fd = open("/dev/null", O_RDONLY | O_CLOEXEC);
	assert_true(fd >= 0);
	return fd;
}

static void descriptors_are_kept_or_closed(void **state)
{
	struct reader reader;
	uint8_t bytes[64];
	bool complete;
	(void)state;
	message(bytes, "body");
	reader_init(&reader);
	int kept = some_fd(), second = some_fd();
	reader_take_fd(&reader, kept);
	reader_take_fd(&reader, second);
	assert_false(is_open(second)); // one is enough
	give(&reader, bytes, CANDIL_HEADER_BYTES, &complete);
	int late = some_fd();
	reader_take_fd(&reader, late);
	assert_false(is_open(late)); // not with the header
	give(&reader, bytes + CANDIL_HEADER_BYTES, 4, &complete);
	assert_true(complete);
	assert_int_equal(reader_claim_fd(&reader), kept);
	assert_int_equal(reader_claim_fd(&reader), -1);
	reader_next(&reader);
	assert_true(is_open(kept)); // claimed: ours
	reader_take_fd(&reader, kept);
	reader_finish(&reader);
	assert_false(is_open(kept)); // unclaimed: closed with the message
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(every_cut_gives_the_same_messages),
	    cmocka_unit_test(wrong_headers_are_named),
	    cmocka_unit_test(the_limit_itself_is_allowed),
	    cmocka_unit_test(descriptors_are_kept_or_closed),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
