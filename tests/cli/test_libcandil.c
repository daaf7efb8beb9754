// libcandil against a daemon that this program plays itself.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <fcntl.h>
#include <pb_decode.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/cli/fake_server.h"

static void test_hello_says_what_the_daemon_is(void **state)
{
	(void)state;
	struct fake f = start();
	assert_string_equal(candil_server(f.client)->name, "fake");
	assert_int_equal(candil_server(f.client)->max_pixels, 1000);
	stop(&f);
}

static void test_hello_refused(void **state)
{
	(void)state;
	struct candil_error error;
	candil_client *client;
	int ends[2];
	socketpair(AF_UNIX, SOCK_STREAM, 0, ends);
	put_error(ends[1], 1, STATUS_NOT_ALLOWED, "not you");
	assert_int_equal(candil_connect_fd(ends[0], &client, &error), CANDIL_STATUS_NOT_ALLOWED);
	assert_null(client);
	assert_string_equal(error.text, "not you");
	close(ends[1]);

	socketpair(AF_UNIX, SOCK_STREAM, 0, ends);
	close(ends[1]);
	assert_int_equal(candil_connect_fd(ends[0], &client, &error), CANDIL_STATUS_CONNECT);

	socketpair(AF_UNIX, SOCK_STREAM, 0, ends);
	put(ends[1], "HTTP/1.1 400 Bad Request\r\n\r\n", 28);
	assert_int_equal(candil_connect_fd(ends[0], &client, &error), CANDIL_STATUS_BAD_MAGIC);
	close(ends[1]);
}

static void test_nobody_listens(void **state)
{
	(void)state;
	struct candil_error error;
	candil_client *client;
	assert_int_equal(candil_connect("no/such/socket", &client, &error), CANDIL_STATUS_CONNECT);
	assert_null(client);
	char longer[300];
	memset(longer, 'a', sizeof(longer) - 1);
	longer[sizeof(longer) - 1] = '\0';
	assert_int_equal(candil_connect(longer, &client, &error), CANDIL_STATUS_BAD_ARGUMENT);
}

static void test_image_is_put_together_from_chunks(void **state)
{
	(void)state;
	enum { BYTES = 150000 };
	struct fake f = start();
	uint8_t *bytes = malloc(BYTES);
	fill(bytes, BYTES, 1);
	uint32_t id = submit_render(f.client, 64);
	candil_Accepted accepted = {.technique = candil_Technique_TECHNIQUE_PT, .plan_count = 1, .depth = 8};
	accepted.plan[0].effect = candil_Effect_EFFECT_EMITTERS;
	strcpy(accepted.plan[0].why, "12 emissive triangles");
	put_message(f.peer, MESSAGE_ACCEPTED, id, candil_Accepted_fields, &accepted);
	assert_string_equal(expect(&f, CANDIL_EVENT_ACCEPTED, id).u.accepted.plan[0].why, "12 emissive triangles");
	put_image(f.peer, id, 64, BYTES, true);
	struct candil_event event;
	for (size_t at = 0; at < BYTES;) {
		size_t part = at + 60001 < BYTES ? 60001 : BYTES - at;
		assert_false(candil_next_event(f.client, &event));
		put_raw(f.peer, MESSAGE_FRAME_CHUNK, id, bytes + at, part);
		candil_process(f.client, NULL);
		at += part;
	}
	event = expect(&f, CANDIL_EVENT_IMAGE, id);
	assert_true(event.u.image.final);
	assert_false(event.ends_request);
	assert_int_equal(event.u.image.bytes, BYTES);
	assert_memory_equal(event.u.image.data, bytes, BYTES);
	put_done(f.peer, id);
	event = expect(&f, CANDIL_EVENT_DONE, id);
	assert_true(event.ends_request);
	assert_int_equal(event.u.done.stages[0].us, 1234);
	// What is no number is passed over.
	assert_int_equal(event.u.done.figure_count, 2);
	assert_string_equal(event.u.done.figures[0].name, "voxel");
	assert_string_equal(event.u.done.figures[0].unit, "m");
	assert_true(event.u.done.figures[0].value == 0.25);
	assert_true(event.u.done.figures[1].value == 1e300);
	free(bytes);
	stop(&f);
}

// What is absent reads as 0, which is no error of 0.
static void test_an_absent_error_is_unknown(void **state)
{
	(void)state;
	const struct {
		candil_Done done;
		enum candil_error_kind kind;
		double relmse, low, high;
	} cases[] = {
	    {{0}, CANDIL_ERROR_KIND_UNKNOWN, -1, -1, -1},
	    {{.estimated_relmse = 0.25, .relmse_high = 0.5}, CANDIL_ERROR_KIND_UNKNOWN, -1, -1, -1},
	    {{.estimated_relmse = 0.25, .error_kind = (candil_ErrorKind)9}, CANDIL_ERROR_KIND_UNKNOWN, -1, -1, -1},
	    {{.estimated_relmse = -1, .error_kind = candil_ErrorKind_ERROR_KIND_MEASURED},
	     CANDIL_ERROR_KIND_UNKNOWN,
	     -1,
	     -1,
	     -1},
	    {{.error_kind = candil_ErrorKind_ERROR_KIND_MEASURED}, CANDIL_ERROR_KIND_MEASURED, 0, 0, 0},
	    {{.estimated_relmse = 0.25,
	      .relmse_low = 0.125,
	      .relmse_high = -1,
	      .error_kind = candil_ErrorKind_ERROR_KIND_PREDICTED},
	     CANDIL_ERROR_KIND_PREDICTED,
	     0.25,
	     0.125,
	     -1},
	};
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct fake f = start();
		uint32_t id = submit_render(f.client, 4);
		put_image(f.peer, id, 4, 1, true);
		put_raw(f.peer, MESSAGE_FRAME_CHUNK, id, "x", 1);
		expect(&f, CANDIL_EVENT_IMAGE, id);
		put_message(f.peer, MESSAGE_DONE, id, candil_Done_fields, &cases[i].done);
		const struct candil_event event = expect(&f, CANDIL_EVENT_DONE, id);
		assert_int_equal(event.u.done.error_kind, cases[i].kind);
		assert_true(event.u.done.estimated_relmse == cases[i].relmse);
		assert_true(event.u.done.relmse_low == cases[i].low);
		assert_true(event.u.done.relmse_high == cases[i].high);
		stop(&f);
	}
}

static void test_renders_interleave(void **state)
{
	(void)state;
	struct fake f = start();
	uint32_t a = submit_render(f.client, 8), b = submit_render(f.client, 16);
	assert_int_not_equal(a, b);
	put_image(f.peer, a, 8, 4, true);
	put_image(f.peer, b, 16, 6, false);
	put_raw(f.peer, MESSAGE_FRAME_CHUNK, b, "bbb", 3);
	put_raw(f.peer, MESSAGE_FRAME_CHUNK, a, "aa", 2);
	put_raw(f.peer, MESSAGE_FRAME_CHUNK, b, "BBB", 3);
	put_raw(f.peer, MESSAGE_FRAME_CHUNK, a, "AA", 2);
	put_error(f.peer, b, STATUS_MEMORY, "too big");
	put_done(f.peer, a);
	struct candil_event event = expect(&f, CANDIL_EVENT_IMAGE, b);
	assert_false(event.u.image.final);
	assert_memory_equal(event.u.image.data, "bbbBBB", 6);
	event = expect(&f, CANDIL_EVENT_IMAGE, a);
	assert_memory_equal(event.u.image.data, "aaAA", 4);
	candil_keep_image(f.client, &event.u.image);
	const uint8_t *kept = event.u.image.data;
	event = expect(&f, CANDIL_EVENT_ERROR, b);
	assert_int_equal(event.u.error.code, CANDIL_STATUS_MEMORY);
	assert_string_equal(event.u.error.text, "too big");
	expect(&f, CANDIL_EVENT_DONE, a);
	assert_memory_equal(kept, "aaAA", 4);
	candil_free(kept);
	assert_int_equal(candil_process(f.client, NULL), CANDIL_STATUS_OK);
	stop(&f);
}

static void test_one_byte_at_a_time(void **state)
{
	(void)state;
	struct fake f = start();
	uint32_t id;
	assert_int_equal(candil_submit_describe(f.client, "box", &id, NULL), CANDIL_STATUS_OK);
	static candil_SceneInfo info = {
	    .name = "box", .triangles = 36, .warnings_count = 2, .has_bounds_max = true, .bounds_max = {1, 2, 3}};
	strcpy(info.warnings[1], "tab\tbell\a, \xff and \xc3\xa9");
	uint8_t body[LIMIT_MESSAGE_BYTES], out[CANDIL_HEADER_BYTES + LIMIT_MESSAGE_BYTES];
	size_t bytes = frame(out, MESSAGE_SCENE_INFO, id, body, encode(body, sizeof(body), candil_SceneInfo_fields, &info));
	struct candil_event event;
	for (size_t i = 0; i + 1 < bytes; i++) {
		put(f.peer, out + i, 1);
		assert_int_equal(candil_process(f.client, NULL), CANDIL_STATUS_OK);
		assert_false(candil_next_event(f.client, &event));
	}
	put(f.peer, out + bytes - 1, 1);
	event = expect(&f, CANDIL_EVENT_SCENE, id);
	assert_int_equal(event.u.scene.triangles, 36);
	assert_true(event.u.scene.bounds_max.z == 3);
	assert_string_equal(event.u.scene.warnings[1], "tab bell?, ? and \xc3\xa9");
	stop(&f);
}

static void test_peer_gone_ends_every_request(void **state)
{
	(void)state;
	struct fake f = start();
	uint32_t ping, render = submit_render(f.client, 8);
	candil_submit_ping(f.client, "x", 1, &ping, NULL);
	candil_process(f.client, NULL);
	put_raw(f.peer, MESSAGE_PONG, ping, "\x0a\x01x", 3);
	put_image(f.peer, render, 8, 100, true);
	drain(f.peer);
	close(f.peer);
	f.peer = -1;
	struct candil_event event = expect(&f, CANDIL_EVENT_PONG, ping);
	assert_int_equal(event.u.pong.bytes, 1);
	event = expect(&f, CANDIL_EVENT_ERROR, render);
	assert_int_equal(event.u.error.code, CANDIL_STATUS_IO);
	assert_true(event.ends_request);
	assert_false(candil_next_event(f.client, &event));
	assert_int_equal(candil_process(f.client, NULL), CANDIL_STATUS_IO);
	assert_int_equal(candil_submit_ping(f.client, "x", 1, &ping, NULL), CANDIL_STATUS_IO);
	assert_int_equal(candil_ping(f.client, NULL, NULL), CANDIL_STATUS_IO);
	stop(&f);
}

static void test_last_words_are_heard(void **state)
{
	(void)state;
	struct fake f = start();
	uint32_t id = submit_render(f.client, 8);
	put_error(f.peer, 0, STATUS_SHUTTING_DOWN, "going down");
	close(f.peer);
	f.peer = -1;
	struct candil_event event = expect(&f, CANDIL_EVENT_ERROR, id);
	assert_int_equal(event.u.error.code, CANDIL_STATUS_SHUTTING_DOWN);
	stop(&f);
}

static void test_blocking_render(void **state)
{
	(void)state;
	struct fake f = start();
	candil_Progress progress = {.samples_done = 2, .samples = 4, .fraction = 0.5, .stage = "render"};
	put_message(f.peer, MESSAGE_PROGRESS, 2, candil_Progress_fields, &progress);
	put_image(f.peer, 2, 512, 5, true);
	put_raw(f.peer, MESSAGE_FRAME_CHUNK, 2, "image", 5);
	put_done(f.peer, 2);
	struct candil_render_request request;
	struct candil_render_result result;
	candil_render_request_init(&request);
	assert_int_equal(candil_render(f.client, &request, NULL, &result, NULL), CANDIL_STATUS_BAD_ARGUMENT);
	request.scene = "box";
	assert_int_equal(candil_render(f.client, &request, NULL, &result, NULL), CANDIL_STATUS_OK);
	assert_int_equal(result.image.bytes, 5);
	assert_memory_equal(result.image.data, "image", 5);
	assert_int_equal(result.done.rays, 77);
	candil_free(result.image.data);
	stop(&f);
}

static int stop_it(void *user, const struct candil_progress *progress)
{
	++*(int *)user;
	return progress->fraction >= 0.5;
}

static void test_callback_cancels(void **state)
{
	(void)state;
	struct fake f = start();
	int calls = 0;
	candil_Progress progress = {.fraction = 0.75};
	put_message(f.peer, MESSAGE_PROGRESS, 2, candil_Progress_fields, &progress);
	put_raw(f.peer, MESSAGE_OK, 3, NULL, 0);
	put_error(f.peer, 2, STATUS_CANCELLED, "cancelled by the client");
	struct candil_render_request request;
	struct candil_render_result result;
	struct candil_error error;
	struct candil_callbacks callbacks = {.progress = stop_it, .user = &calls};
	candil_render_request_init(&request);
	request.scene = "box";
	assert_int_equal(candil_render(f.client, &request, &callbacks, &result, &error), CANDIL_STATUS_CANCELLED);
	assert_int_equal(calls, 1);
	assert_null(result.image.data);
	stop(&f);
}

static void put_indexed(int fd, uint32_t id, uint32_t index, bool final)
{
	candil_ImageFrame image = {.index = index,
				   .final = final,
				   .format = candil_Format_FORMAT_EXR_FLOAT,
				   .width = 8,
				   .height = 8,
				   .samples = 4,
				   .bytes = 3};
	put_message(fd, MESSAGE_IMAGE, id, candil_ImageFrame_fields, &image);
	put_raw(fd, MESSAGE_FRAME_CHUNK, id, "abc", 3);
}

static struct candil_render_request sweep_request(struct candil_camera *cameras, size_t count)
{
	struct candil_render_request request;
	candil_render_request_init(&request);
	request.scene = "box";
	request.width = request.height = 8;
	for (size_t i = 0; i < count; i++)
		cameras[i] = (struct candil_camera){.name = "c"};
	return request;
}

struct sweep_seen {
	unsigned images, finals;
	unsigned stop_at; // cancel on this final image; 0: never
};

static int see_image(void *user, const struct candil_image *image)
{
	struct sweep_seen *seen = user;
	assert_int_equal(image->index, seen->finals);
	assert_memory_equal(image->data, "abc", 3);
	seen->images++;
	seen->finals += image->final;
	return seen->stop_at > 0 && seen->finals == seen->stop_at;
}

static void test_blocking_sweep(void **state)
{
	(void)state;
	struct fake f = start();
	static struct candil_camera cameras[CANDIL_SWEEP_CAMERAS + 1];
	struct candil_render_request request = sweep_request(cameras, CANDIL_SWEEP_CAMERAS + 1);
	struct sweep_seen seen = {0};
	const struct candil_callbacks callbacks = {.image = see_image, .user = &seen};
	struct candil_sweep_result result;
	assert_int_equal(candil_sweep(f.client, &request, cameras, 0, &callbacks, &result, NULL), CANDIL_STATUS_LIMIT);
	assert_int_equal(candil_sweep(f.client, &request, cameras, CANDIL_SWEEP_CAMERAS + 1, &callbacks, &result, NULL),
			 CANDIL_STATUS_LIMIT);
	put_indexed(f.peer, 2, 0, true);
	put_indexed(f.peer, 2, 1, false);
	put_indexed(f.peer, 2, 1, true);
	put_indexed(f.peer, 2, 2, true);
	put_done(f.peer, 2);
	assert_int_equal(candil_sweep(f.client, &request, cameras, 3, &callbacks, &result, NULL), CANDIL_STATUS_OK);
	assert_int_equal(seen.images, 4);
	assert_int_equal(seen.finals, 3);
	assert_int_equal(result.done.rays, 77);
	seen = (struct sweep_seen){.stop_at = 1};
	put_indexed(f.peer, 3, 0, true);
	put_error(f.peer, 3, CANDIL_STATUS_CANCELLED, "cancelled as asked");
	assert_int_equal(candil_sweep(f.client, &request, cameras, 2, &callbacks, &result, NULL), CANDIL_STATUS_CANCELLED);
	assert_int_equal(seen.finals, 1);
	stop(&f);
}

// Images out of order, one too many, one too few: each ends the connection.
static void test_sweep_broken(void **state)
{
	(void)state;
	for (unsigned how = 0; how < 3; how++) {
		struct fake f = start();
		struct candil_camera cameras[2];
		struct candil_render_request request = sweep_request(cameras, 2);
		struct candil_event event;
		uint32_t id;
		assert_int_equal(candil_submit_sweep(f.client, &request, cameras, 2, &id, NULL), CANDIL_STATUS_OK);
		put_indexed(f.peer, id, 0, true);
		if (how == 0)
			put_done(f.peer, id);
		else
			put_indexed(f.peer, id, how == 1 ? 0 : 2, true);
		event = expect(&f, CANDIL_EVENT_IMAGE, id);
		assert_int_equal(event.u.image.index, 0);
		event = expect(&f, CANDIL_EVENT_ERROR, id);
		assert_int_equal(event.u.error.code, CANDIL_STATUS_IO);
		stop(&f);
	}
}

static void test_blocking_calls_refuse_beside_open_requests(void **state)
{
	(void)state;
	struct fake f = start();
	uint32_t id = submit_render(f.client, 8);
	assert_int_equal(candil_ping(f.client, NULL, NULL), CANDIL_STATUS_BAD_ARGUMENT);
	assert_int_equal(candil_cancel(f.client, id + 1, NULL), CANDIL_STATUS_NO_SUCH_REQUEST);
	assert_int_equal(candil_cancel(f.client, id, NULL), CANDIL_STATUS_OK);
	put_error(f.peer, id, STATUS_CANCELLED, "cancelled");
	put_raw(f.peer, MESSAGE_OK, id + 1, NULL, 0);
	expect(&f, CANDIL_EVENT_ERROR, id);
	put_raw(f.peer, MESSAGE_PONG, id + 2,
		"\x0a\x07"
		"candil\0",
		9);
	uint64_t us;
	assert_int_equal(candil_ping(f.client, &us, NULL), CANDIL_STATUS_OK);
	stop(&f);
}

static void test_silence_times_out(void **state)
{
	(void)state;
	struct fake f = start();
	struct candil_error error;
	candil_set_timeout(f.client, 20);
	assert_int_equal(candil_ping(f.client, NULL, &error), CANDIL_STATUS_IO);
	assert_non_null(strstr(error.text, "nothing"));
	stop(&f);
}

static void test_load_carries_its_folder(void **state)
{
	(void)state;
	char folder[] = "candil-test-XXXXXX", file[64];
	assert_non_null(mkdtemp(folder));
	snprintf(file, sizeof(file), "%s/scene.gltf", folder);
	close(open(file, O_CREAT | O_WRONLY, 0600));
	struct fake f = start();
	struct candil_load_request request = {.name = "s", .file = file};
	struct candil_error error;
	uint32_t id, first;
	candil_submit_ping(f.client, "before", 6, &first, NULL);
	assert_int_equal(candil_submit_load(f.client, &request, &id, &error), CANDIL_STATUS_OK);
	candil_process(f.client, NULL);
	drain(f.peer);

	// Again, alone, and looked at: the descriptor comes with the header's first byte.
	assert_int_equal(candil_submit_load(f.client, &request, &id, &error), CANDIL_STATUS_OK);
	candil_process(f.client, NULL);
	uint8_t bytes[4096];
	struct iovec part = {bytes, sizeof(bytes)};
	union {
		struct cmsghdr align;
		char room[CMSG_SPACE(sizeof(int))];
	} control;
	struct msghdr message = {
	    .msg_iov = &part, .msg_iovlen = 1, .msg_control = control.room, .msg_controllen = sizeof(control.room)};
	ssize_t got = recvmsg(f.peer, &message, MSG_CMSG_CLOEXEC);
	assert_true(got > (ssize_t)CANDIL_HEADER_BYTES);
	struct header header;
	assert_int_equal(header_decode(bytes, &header), STATUS_OK);
	assert_int_equal(header.flags, HEADER_FLAG_FD);
	assert_int_equal(header.type, MESSAGE_LOAD);
	struct cmsghdr *c = CMSG_FIRSTHDR(&message);
	assert_non_null(c);
	int fd;
	memcpy(&fd, CMSG_DATA(c), sizeof(fd));
	candil_Load load = candil_Load_init_zero;
	pb_istream_t stream = pb_istream_from_buffer(bytes + CANDIL_HEADER_BYTES, header.length);
	assert_true(pb_decode(&stream, candil_Load_fields, &load));
	assert_string_equal(load.path, "scene.gltf");
	struct stat there, here;
	assert_int_equal(fstatat(fd, load.path, &there, 0), 0);
	assert_int_equal(stat(file, &here), 0);
	assert_int_equal(there.st_ino, here.st_ino);
	close(fd);

	request.file = "no/such/file.gltf";
	assert_int_equal(candil_submit_load(f.client, &request, &id, &error), CANDIL_STATUS_SCENE_FILE);
	request.file = folder;
	assert_int_equal(candil_submit_load(f.client, &request, &id, &error), CANDIL_STATUS_SCENE_FILE);
	request.server_path = "both.gltf";
	assert_int_equal(candil_submit_load(f.client, &request, &id, &error), CANDIL_STATUS_BAD_ARGUMENT);
	stop(&f);
	unlink(file);
	rmdir(folder);
}

static void test_too_long_strings_are_refused_here(void **state)
{
	(void)state;
	struct fake f = start();
	struct candil_error error;
	char name[65];
	uint32_t id;
	memset(name, 'n', 64);
	name[64] = '\0';
	assert_int_equal(candil_submit_describe(f.client, name, &id, &error), CANDIL_STATUS_BAD_ARGUMENT);
	name[63] = '\0';
	assert_int_equal(candil_submit_describe(f.client, name, &id, &error), CANDIL_STATUS_OK);
	struct candil_render_request request;
	struct candil_option options[17] = {{"pt.depth", "12345678901234567890123456789012"}};
	candil_render_request_init(&request);
	request.scene = "box";
	request.options = options;
	request.option_count = 1;
	assert_int_equal(candil_submit_render(f.client, &request, &id, &error), CANDIL_STATUS_BAD_ARGUMENT);
	request.option_count = 17;
	assert_int_equal(candil_submit_render(f.client, &request, &id, &error), CANDIL_STATUS_LIMIT);
	stop(&f);
}

static void test_many_open_requests(void **state)
{
	(void)state;
	struct fake f = start();
	uint32_t id, ids[64];
	for (int i = 0; i < 64; i++)
		assert_int_equal(candil_submit_stats(f.client, &ids[i], NULL), CANDIL_STATUS_OK);
	assert_int_equal(candil_submit_stats(f.client, &id, NULL), CANDIL_STATUS_TOO_MANY_JOBS);
	candil_StatsReply reply = {.jobs_done = 9};
	put_message(f.peer, MESSAGE_STATS_REPLY, ids[40], candil_StatsReply_fields, &reply);
	assert_int_equal(expect(&f, CANDIL_EVENT_STATS, ids[40]).u.stats.jobs_done, 9);
	assert_int_equal(candil_submit_stats(f.client, &id, NULL), CANDIL_STATUS_OK);
	stop(&f);
}

// ---- NULL, and calls on a connection that has failed -----------------------------------------------------------------

// The pointer, but the one whose turn it is to be NULL.
static const void *unless(int turn, int number, const void *pointer)
{
	return turn == number ? NULL : pointer;
}
#define ARG(number, pointer) ((void *)(uintptr_t)unless(turn, (number), (pointer)))

struct given {
	candil_client *client, *other;
	struct candil_error error;
	struct candil_load_request load;
	struct candil_render_request render;
	struct candil_camera cameras[1];
	uint32_t id;
	union {
		struct candil_scene_info info;
		struct candil_scene_list list;
		struct candil_stats stats;
		struct candil_quote quote;
		struct candil_render_result render;
		struct candil_sweep_result sweep;
	} out;
};

#define CALL(name, ...) \
	static candil_status call_##name(struct given *g, int turn) \
	{ \
		return candil_##name(__VA_ARGS__); \
	}
CALL(connect, ARG(1, "no/such/socket"), ARG(0, &g->other), ARG(2, &g->error))
CALL(connect_fd, open("/dev/null", O_RDWR | O_CLOEXEC), ARG(0, &g->other), ARG(1, &g->error))
CALL(ping, ARG(0, g->client), ARG(1, NULL), ARG(2, &g->error))
CALL(load, ARG(0, g->client), ARG(1, &g->load), ARG(2, &g->out.info), ARG(3, &g->error))
CALL(load_file, ARG(0, g->client), ARG(1, "box"), ARG(2, "/dev/null"), ARG(3, &g->out.info), ARG(4, &g->error))
CALL(unload, ARG(0, g->client), ARG(1, "box"), ARG(2, &g->error))
CALL(scenes, ARG(0, g->client), ARG(1, &g->out.list), ARG(2, &g->error))
CALL(describe, ARG(0, g->client), ARG(1, "box"), ARG(2, &g->out.info), ARG(3, &g->error))
CALL(stats, ARG(0, g->client), ARG(1, &g->out.stats), ARG(2, &g->error))
CALL(render, ARG(0, g->client), ARG(1, &g->render), ARG(3, NULL), ARG(2, &g->out.render), ARG(4, &g->error))
CALL(sweep, ARG(0, g->client), ARG(1, &g->render), ARG(2, g->cameras), 1, ARG(4, NULL), ARG(3, &g->out.sweep),
     ARG(5, &g->error))
CALL(ask_quote, ARG(0, g->client), ARG(1, &g->render), 0, ARG(2, &g->out.quote), ARG(3, &g->error))
CALL(process, ARG(0, g->client), ARG(1, &g->error))
CALL(submit_ping, ARG(0, g->client), ARG(1, "x"), 1, ARG(2, &g->id), ARG(3, &g->error))
CALL(submit_load, ARG(0, g->client), ARG(1, &g->load), ARG(2, &g->id), ARG(3, &g->error))
CALL(submit_unload, ARG(0, g->client), ARG(1, "box"), ARG(2, &g->id), ARG(3, &g->error))
CALL(submit_scenes, ARG(0, g->client), ARG(1, &g->id), ARG(2, &g->error))
CALL(submit_describe, ARG(0, g->client), ARG(1, "box"), ARG(2, &g->id), ARG(3, &g->error))
CALL(submit_render, ARG(0, g->client), ARG(1, &g->render), ARG(2, &g->id), ARG(3, &g->error))
CALL(submit_sweep, ARG(0, g->client), ARG(1, &g->render), ARG(2, g->cameras), 1, ARG(3, &g->id), ARG(4, &g->error))
CALL(submit_quote, ARG(0, g->client), ARG(1, &g->render), 0, ARG(2, &g->id), ARG(3, &g->error))
CALL(submit_stats, ARG(0, g->client), ARG(1, &g->id), ARG(2, &g->error))
CALL(cancel, ARG(0, g->client), 7, ARG(1, &g->error))

// Pointers are numbered so that those which must be there come first.
static const struct call {
	const char *name;
	candil_status (*make)(struct given *g, int turn);
	int needed, all;
	candil_status without_null; // what comes of it on a connection that has failed
} calls[] = {
#define ROW(name, needed, all, status) \
	{ \
#name, call_##name, needed, all, CANDIL_STATUS_##status \
	}
    ROW(connect, 1, 3, CONNECT),
    ROW(connect_fd, 1, 2, BAD_ARGUMENT),
    ROW(ping, 1, 3, IO),
    ROW(load, 2, 4, IO),
    ROW(load_file, 3, 5, SCENE_FILE),
    ROW(unload, 2, 3, IO),
    ROW(scenes, 2, 3, IO),
    ROW(describe, 3, 4, IO),
    ROW(stats, 2, 3, IO),
    ROW(render, 3, 5, IO),
    ROW(sweep, 4, 6, IO),
    ROW(ask_quote, 3, 4, IO),
    ROW(process, 1, 2, IO),
    ROW(submit_ping, 3, 4, IO),
    ROW(submit_load, 3, 4, IO),
    ROW(submit_unload, 3, 4, IO),
    ROW(submit_scenes, 2, 3, IO),
    ROW(submit_describe, 3, 4, IO),
    ROW(submit_render, 3, 4, IO),
    ROW(submit_sweep, 4, 5, IO),
    ROW(submit_quote, 3, 4, IO),
    ROW(submit_stats, 2, 3, IO),
    ROW(cancel, 1, 2, IO),
#undef ROW
};

static void given_init(struct given *g, candil_client *client)
{
	memset(g, 0, sizeof(*g));
	g->client = client;
	g->load = (struct candil_load_request){.name = "box", .server_path = "box.gltf"};
	candil_render_request_init(&g->render);
	g->render.scene = "box";
	g->id = 99;
}

static void test_null_is_refused_and_a_failed_connection_stays_failed(void **state)
{
	(void)state;
	static struct given g; // large
	struct fake f = start();
	close(f.peer);
	f.peer = -1;
	assert_int_equal(candil_ping(f.client, NULL, NULL), CANDIL_STATUS_IO);
	for (size_t i = 0; i < sizeof(calls) / sizeof(calls[0]); i++) {
		const struct call *c = &calls[i];
		for (int turn = -1; turn < c->all; turn++) {
			given_init(&g, f.client);
			const bool refused = turn >= 0 && turn < c->needed;
			const candil_status wanted = refused ? CANDIL_STATUS_BAD_ARGUMENT : c->without_null;
			const candil_status got = c->make(&g, turn);
			// A null address is the default one.
			if (got != wanted && !(c->make == call_connect && turn == 1 && got != CANDIL_STATUS_OK))
				fail_msg("%s with argument %d NULL: %s", c->name, turn, candil_status_name(got));
			// `error` is the last.
			if (turn != c->all - 1)
				assert_true(g.error.code == got && strlen(g.error.text) > 5);
			assert_true(g.id == 0 || g.id == 99);
			assert_null(g.other);
		}
	}
	stop(&f);
}

static void test_null_does_nothing_where_there_is_no_status(void **state)
{
	(void)state;
	struct fake f = start();
	struct candil_event event;
	struct candil_image image = {0};
	assert_false(candil_default_address(NULL, 100));
	assert_null(candil_server(NULL));
	assert_int_equal(candil_fd(NULL), -1);
	assert_false(candil_wants_write(NULL));
	assert_false(candil_next_event(NULL, &event));
	assert_false(candil_next_event(f.client, NULL));
	candil_set_timeout(NULL, 1);
	candil_render_request_init(NULL);
	candil_keep_image(NULL, &image);
	candil_keep_image(f.client, NULL);
	candil_free(NULL);
	candil_disconnect(NULL);
	stop(&f);
}

static void test_lists_that_are_announced_must_be_there(void **state)
{
	(void)state;
	struct fake f = start();
	const struct candil_edits edits[] = {{.light_count = 1}, {.material_count = 1}, {.node_count = 1}};
	struct candil_render_request request;
	uint32_t id;
	candil_render_request_init(&request);
	request.scene = "box";
	request.option_count = 1;
	assert_int_equal(candil_submit_render(f.client, &request, &id, NULL), CANDIL_STATUS_BAD_ARGUMENT);
	request.option_count = 0;
	for (size_t i = 0; i < 3; i++) {
		request.edits = &edits[i];
		assert_int_equal(candil_submit_render(f.client, &request, &id, NULL), CANDIL_STATUS_BAD_ARGUMENT);
	}
	assert_int_equal(candil_submit_ping(f.client, NULL, 0, &id, NULL), CANDIL_STATUS_OK);
	stop(&f);
}

// At once: none of these would ever become readable.
static void test_descriptors_that_are_no_connection(void **state)
{
	(void)state;
	struct candil_error error;
	int ends[2], pipes[2], closed = dup(0);
	close(closed);
	assert_int_equal(pipe2(pipes, O_CLOEXEC), 0);
	assert_int_equal(socketpair(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0, ends), 0);
	const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
	const struct sockaddr_un nameless = {.sun_family = AF_UNIX}; // the kernel chooses a name
	assert_int_equal(bind(listener, (const struct sockaddr *)&nameless, sizeof(sa_family_t)), 0);
	assert_int_equal(listen(listener, 1), 0);
	const int fds[] = {
	    -1,
	    closed,
	    open("/dev/null", O_RDWR | O_CLOEXEC),
	    open("/", O_RDONLY | O_DIRECTORY | O_CLOEXEC),
	    open("/", O_PATH | O_CLOEXEC),
	    pipes[0],
	    pipes[1],
	    ends[0],
	    listener,
	    socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0),
	};
	for (size_t i = 0; i < sizeof(fds) / sizeof(fds[0]); i++) {
		candil_client *client = NULL;
		if (candil_connect_fd(fds[i], &client, &error) != CANDIL_STATUS_BAD_ARGUMENT)
			fail_msg("case %zu: %s", i, error.text);
		assert_null(client);
		assert_non_null(strstr(error.text, "no connected stream socket"));
		assert_int_equal(fcntl(fds[i], F_GETFD), -1); // it was the client's
	}
	close(ends[1]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_null_is_refused_and_a_failed_connection_stays_failed),
	    cmocka_unit_test(test_null_does_nothing_where_there_is_no_status),
	    cmocka_unit_test(test_lists_that_are_announced_must_be_there),
	    cmocka_unit_test(test_descriptors_that_are_no_connection),
	    cmocka_unit_test(test_hello_says_what_the_daemon_is),
	    cmocka_unit_test(test_hello_refused),
	    cmocka_unit_test(test_nobody_listens),
	    cmocka_unit_test(test_image_is_put_together_from_chunks),
	    cmocka_unit_test(test_an_absent_error_is_unknown),
	    cmocka_unit_test(test_renders_interleave),
	    cmocka_unit_test(test_one_byte_at_a_time),
	    cmocka_unit_test(test_peer_gone_ends_every_request),
	    cmocka_unit_test(test_last_words_are_heard),
	    cmocka_unit_test(test_blocking_render),
	    cmocka_unit_test(test_callback_cancels),
	    cmocka_unit_test(test_blocking_sweep),
	    cmocka_unit_test(test_sweep_broken),
	    cmocka_unit_test(test_blocking_calls_refuse_beside_open_requests),
	    cmocka_unit_test(test_silence_times_out),
	    cmocka_unit_test(test_load_carries_its_folder),
	    cmocka_unit_test(test_too_long_strings_are_refused_here),
	    cmocka_unit_test(test_many_open_requests),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
