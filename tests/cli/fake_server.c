#include "tests/cli/fake_server.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <pb_encode.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

void put(int fd, const void *bytes, size_t count)
{
	assert_int_equal(send(fd, bytes, count, MSG_NOSIGNAL), (ssize_t)count);
}

size_t frame(uint8_t *out, enum message_type type, uint32_t id, const void *body, size_t bytes)
{
	struct header h = {CANDIL_VERSION, (uint8_t)type, 0, (uint32_t)bytes, id};
	header_encode(&h, out);
	if (bytes > 0)
		memcpy(out + CANDIL_HEADER_BYTES, body, bytes);
	return CANDIL_HEADER_BYTES + bytes;
}

void put_raw(int fd, enum message_type type, uint32_t id, const void *body, size_t bytes)
{
	uint8_t out[CANDIL_HEADER_BYTES + LIMIT_MESSAGE_BYTES];
	put(fd, out, frame(out, type, id, body, bytes));
}

size_t encode(uint8_t *out, size_t capacity, const pb_msgdesc_t *fields, const void *message)
{
	pb_ostream_t stream = pb_ostream_from_buffer(out, capacity);
	assert_true(pb_encode(&stream, fields, message));
	return stream.bytes_written;
}

void put_message(int fd, enum message_type type, uint32_t id, const pb_msgdesc_t *fields, const void *message)
{
	uint8_t body[LIMIT_MESSAGE_BYTES];
	put_raw(fd, type, id, body, encode(body, sizeof(body), fields, message));
}

void put_error(int fd, uint32_t id, uint32_t code, const char *text)
{
	candil_Error e = {.code = code};
	snprintf(e.message, sizeof(e.message), "%s", text);
	put_message(fd, MESSAGE_ERROR, id, candil_Error_fields, &e);
}

void put_image(int fd, uint32_t id, uint32_t side, uint64_t bytes, bool final)
{
	candil_ImageFrame image = {.final = final,
				   .format = candil_Format_FORMAT_EXR_FLOAT,
				   .width = side,
				   .height = side,
				   .samples = 4,
				   .bytes = bytes};
	put_message(fd, MESSAGE_IMAGE, id, candil_ImageFrame_fields, &image);
}

void put_done(int fd, uint32_t id)
{
	candil_Done done = {.samples = 4,
			    .rays = 77,
			    .estimated_relmse = 0.25,
			    .error_kind = candil_ErrorKind_ERROR_KIND_MEASURED,
			    .stages_count = 1,
			    .figures_count = 3};
	strcpy(done.stages[0].name, "trace");
	done.stages[0].us = 1234;
	strcpy(done.figures[0].name, "levels");
	done.figures[0].value = NAN;
	strcpy(done.figures[1].name, "voxel");
	strcpy(done.figures[1].unit, "m");
	done.figures[1].value = 0.25;
	strcpy(done.figures[2].name, "entries");
	done.figures[2].value = 1e300;
	put_message(fd, MESSAGE_DONE, id, candil_Done_fields, &done);
}

// Drop what the client sent; returns how many bytes that was.
size_t drain(int fd)
{
	uint8_t bytes[65536];
	size_t all = 0;
	ssize_t got;
	while ((got = recv(fd, bytes, sizeof(bytes), MSG_DONTWAIT)) > 0)
		all += (size_t)got;
	return all;
}

struct fake start(void)
{
	int ends[2];
	struct fake f;
	assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
	f.peer = ends[1];
	candil_HelloReply hello = {.version = CANDIL_VERSION, .server = "fake", .max_pixels = 1000};
	put_message(f.peer, MESSAGE_HELLO_REPLY, 1, candil_HelloReply_fields, &hello);
	struct candil_error error;
	assert_int_equal(candil_connect_fd(ends[0], &f.client, &error), CANDIL_STATUS_OK);
	assert_true(drain(f.peer) > CANDIL_HEADER_BYTES);
	return f;
}

void stop(struct fake *f)
{
	candil_disconnect(f->client);
	if (f->peer >= 0)
		close(f->peer);
}

uint32_t submit_render(candil_client *client, uint32_t side)
{
	struct candil_render_request request;
	uint32_t id = 0;
	candil_render_request_init(&request);
	request.scene = "box";
	request.width = request.height = side;
	assert_int_equal(candil_submit_render(client, &request, &id, NULL), CANDIL_STATUS_OK);
	return id;
}

// The next event, which must be there or arrive with what was sent already.
struct candil_event expect(struct fake *f, enum candil_event_kind kind, uint32_t id)
{
	struct candil_event event;
	candil_process(f->client, NULL);
	assert_true(candil_next_event(f->client, &event));
	assert_int_equal(event.kind, kind);
	assert_int_equal(event.id, id);
	return event;
}

void fill(uint8_t *bytes, size_t count, unsigned seed)
{
	for (size_t i = 0; i < count; i++)
		bytes[i] = (uint8_t)(i * 31 + i / 251 + seed);
}
