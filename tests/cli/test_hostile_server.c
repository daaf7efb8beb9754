// libcandil against a daemon that breaks the protocol: no crash, no leak, and every request ends.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <string.h>
#include <unistd.h>

#include "tests/cli/fake_server.h"

// What a hostile daemon might say to render 2 (64x64): each ends the connection, and the request with it.
static void hostile(void (*say)(int peer, uint32_t id))
{
	struct fake f = start();
	uint32_t id = submit_render(f.client, 64);
	candil_process(f.client, NULL);
	say(f.peer, id);
	struct candil_event event = expect(&f, CANDIL_EVENT_ERROR, id);
	assert_true(event.u.error.code != CANDIL_STATUS_OK);
	assert_true(strlen(event.u.error.text) > 10);
	assert_int_equal(candil_process(f.client, NULL), event.u.error.code);
	stop(&f);
}

static void say_huge_image(int peer, uint32_t id)
{
	put_image(peer, id, 64, UINT64_MAX, true);
}
static void say_empty_image(int peer, uint32_t id)
{
	put_image(peer, id, 64, 0, true);
}
static void say_other_size(int peer, uint32_t id)
{
	put_image(peer, id, 65, 10, true);
}
static void say_chunk_without_image(int peer, uint32_t id)
{
	put_raw(peer, MESSAGE_FRAME_CHUNK, id, "abc", 3);
}
static void say_chunk_too_long(int peer, uint32_t id)
{
	put_image(peer, id, 64, 2, true);
	put_raw(peer, MESSAGE_FRAME_CHUNK, id, "abc", 3);
}
static void say_image_in_image(int peer, uint32_t id)
{
	put_image(peer, id, 64, 20, false);
	put_image(peer, id, 64, 20, true);
}
static void say_done_without_image(int peer, uint32_t id)
{
	put_done(peer, id);
}
static void say_wrong_reply(int peer, uint32_t id)
{
	put_raw(peer, MESSAGE_OK, id, NULL, 0);
}
static void say_garbage_message(int peer, uint32_t id)
{
	put_raw(peer, MESSAGE_PROGRESS, id, "\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff", 11);
}
static void say_bad_magic(int peer, uint32_t id)
{
	(void)id;
	put(peer, "JUNKJUNKJUNKJUNK", 16);
}
static void say_long_length(int peer, uint32_t id)
{
	struct header h = {CANDIL_VERSION, MESSAGE_PROGRESS, 0, UINT32_MAX, id};
	uint8_t out[CANDIL_HEADER_BYTES];
	header_encode(&h, out);
	put(peer, out, sizeof(out));
}

static void test_hostile_replies(void **state)
{
	(void)state;
	hostile(say_huge_image);
	hostile(say_empty_image);
	hostile(say_other_size);
	hostile(say_chunk_without_image);
	hostile(say_chunk_too_long);
	hostile(say_image_in_image);
	hostile(say_done_without_image);
	hostile(say_wrong_reply);
	hostile(say_garbage_message);
	hostile(say_bad_magic);
	hostile(say_long_length);
}

static void test_strange_but_harmless_replies_are_passed_over(void **state)
{
	(void)state;
	struct fake f = start();
	uint32_t id;
	candil_submit_unload(f.client, "box", &id, NULL);
	put_raw(f.peer, MESSAGE_FRAME_CHUNK, 999, "abc", 3);
	put_raw(f.peer, (enum message_type)0xC0, id, "later", 5);
	put_done(f.peer, 4711);
	put_raw(f.peer, MESSAGE_OK, id, NULL, 0);
	assert_true(expect(&f, CANDIL_EVENT_OK, id).ends_request);
	stop(&f);
}

// Every reply of the protocol's list, to a request that OK ends. A reply that is new in the list must not be passed over, or
// whoever waits for it waits for ever.
static void test_no_known_reply_is_passed_over(void **state)
{
	(void)state;
#define X(name, number, ...) (number),
	static const uint8_t replies[] = {CANDIL_REPLY_LIST(X)};
#undef X
	for (size_t i = 0; i < sizeof(replies); i++) {
		struct fake f = start();
		uint32_t id;
		candil_submit_unload(f.client, "box", &id, NULL);
		put_raw(f.peer, (enum message_type)replies[i], id, NULL, 0);
		assert_true(expect(&f, replies[i] == MESSAGE_OK ? CANDIL_EVENT_OK : CANDIL_EVENT_ERROR, id).ends_request);
		stop(&f);
	}
}

// Whatever the server sends as shares, a caller gets numbers from 0 to 1.
static void assert_shares(const struct candil_verdict *v)
{
	assert_true(v->black >= 0 && v->black <= 1 && v->clipped >= 0 && v->clipped <= 1 && v->missed >= 0 &&
		    v->missed <= 1);
}

// A valid conversation with random bytes changed: whatever happens, no crash, no leak, and an end.
static void test_mutated_replies(void **state)
{
	(void)state;
	uint32_t random = 12345;
	for (int round = 0; round < 3000; round++) {
		struct fake f = start();
		uint32_t id = submit_render(f.client, 8);
		uint8_t out[4096], body[512];
		candil_Progress progress = {.samples_done = 1, .samples = 4, .fraction = 0.5};
		candil_ImageFrame image = {.format = candil_Format_FORMAT_EXR_FLOAT,
					   .width = 8,
					   .height = 8,
					   .samples = 4,
					   .bytes = 300,
					   .has_verdict = true,
					   .verdict = {.black = NAN, .clipped = -1, .missed = 7}};
		candil_Done done = {.samples = 4, .stages_count = 2};
		size_t n = frame(out, MESSAGE_PROGRESS, id, body, encode(body, 512, candil_Progress_fields, &progress));
		image.final = true;
		image.index = 0;
		n += frame(out + n, MESSAGE_IMAGE, id, body, encode(body, 512, candil_ImageFrame_fields, &image));
		fill(body, 300, 3);
		n += frame(out + n, MESSAGE_FRAME_CHUNK, id, body, 300);
		n += frame(out + n, MESSAGE_DONE, id, body, encode(body, 512, candil_Done_fields, &done));
		for (int change = 0; change < 1 + round % 4; change++) {
			random = random * 1664525u + 1013904223u;
			out[(random >> 8) % n] = (uint8_t)(random >> 24);
		}
		put(f.peer, out, n);
		close(f.peer);
		f.peer = -1;
		candil_process(f.client, NULL);
		struct candil_event event;
		bool ended = false;
		while (candil_next_event(f.client, &event)) {
			ended = ended || event.ends_request;
			if (event.kind == CANDIL_EVENT_IMAGE)
				assert_shares(&event.u.image.verdict);
		}
		assert_true(ended);
		stop(&f);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_hostile_replies),
	    cmocka_unit_test(test_strange_but_harmless_replies_are_passed_over),
	    cmocka_unit_test(test_no_known_reply_is_passed_over),
	    cmocka_unit_test(test_mutated_replies),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
