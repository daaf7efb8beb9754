// Frames through the codec and back through OpenImageIO's reader, and through the encoder's thread and socket.
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmocka.h>

#include "protocol/header.h"
#include "server/base/ipc.h"
#include "server/base/memfd.h"
#include "server/worker/image/codec.h"
#include "server/worker/image/encoder.h"
#include "tests/golden/readback.h"

static struct frame *make_frame(uint32_t width, uint32_t height, uint32_t aovs)
{
	struct frame *f = NULL;
	struct error err;
	assert_int_equal(frame_create(width, height, aovs, &f, &err), STATUS_OK);
	f->samples = 7;
	for (size_t i = 0; i < (size_t)width * height; i++) {
		for (size_t c = 0; c < 3; c++) {
			// Values that half cannot hold.
			f->radiance[3 * i + c] = 0.1f + (float)i * 1.37f + (float)c / 3;
			if (f->normal)
				f->normal[3 * i + c] = c == i % 3 ? -1 : 0;
			if (f->albedo)
				f->albedo[3 * i + c] = (float)(c + 1) / 7;
		}
		if (f->depth)
			f->depth[i] = i % 2 ? INFINITY : 1.0f / (float)(i + 3);
		if (f->id)
			f->id[i] = 0xFFFFFF00u + (uint32_t)(i % 256); // no float holds these
	}
	frame_add_metadata(f, "technique", "%s", "pt");
	frame_add_metadata(f, "spp", "%u", 7u);
	return f;
}

// Encode and read back. The frame stays the caller's.
static struct readback through(const struct frame *f, enum codec_format format, enum codec_view view, double ev)
{
	int fd = -1;
	size_t bytes = 0;
	struct error err = {0};
	enum status s = codec_encode(f, format, view, ev, &fd, &bytes, &err);
	if (s != STATUS_OK)
		fail_msg("%s", err.text);
	const void *map;
	size_t mapped;
	assert_int_equal(memfd_map_sealed(fd, &map, &mapped, &err), STATUS_OK);
	assert_int_equal(mapped, bytes);
	munmap((void *)(uintptr_t)map, mapped);
	struct readback r = {0};
	assert_int_equal(readback_open(fd, bytes, format == CODEC_PNG ? "png" : "exr", &r), 0);
	close(fd);
	assert_int_equal(r.width, f->width);
	assert_int_equal(r.height, f->height);
	return r;
}

static void expect_type(const struct readback *r, const char *name, enum readback_type type)
{
	for (int c = 0; c < r->channels; c++)
		if (!strcmp(r->name[c], name)) {
			assert_int_equal(r->type[c], type);
			return;
		}
	fail_msg("no channel %s", name);
}

static void check_float(uint32_t width, uint32_t height)
{
	struct frame *f = make_frame(width, height, AOV_ALL);
	struct readback r = through(f, CODEC_EXR_FLOAT, CODEC_VIEW_NONE, 0);
	assert_int_equal(r.channels, 11);
	const char *colour[9] = {"R", "G", "B", "N.X", "N.Y", "N.Z", "albedo.R", "albedo.G", "albedo.B"};
	const float *planes[3] = {f->radiance, f->normal, f->albedo};
	for (int i = 0; i < 9; i++)
		expect_type(&r, colour[i], READBACK_FLOAT);
	expect_type(&r, "Z", READBACK_FLOAT);
	expect_type(&r, "id", READBACK_UINT);
	for (uint32_t y = 0; y < height; y++)
		for (uint32_t x = 0; x < width; x++) {
			size_t p = (size_t)y * width + x;
			for (size_t i = 0; i < 9; i++)
				assert_true(readback_value(&r, (int)x, (int)y, colour[i]) ==
					    (double)planes[i / 3][3 * p + i % 3]);
			assert_true(readback_value(&r, (int)x, (int)y, "Z") == (double)f->depth[p]);
			assert_true(readback_value(&r, (int)x, (int)y, "id") == (double)f->id[p]);
		}
	readback_close(&r);
	frame_destroy(f);
}

static void float_exr_is_exact_at_every_size(void **state)
{
	(void)state;
	check_float(1, 1);
	check_float(3, 5);
	check_float(17, 130); // several strips, the last one short
	check_float(300, 1);
}

// Whether a frame's float EXR has this compression, and its values.
static void expect_compression(const struct frame *f, const char *compression)
{
	struct readback r = through(f, CODEC_EXR_FLOAT, CODEC_VIEW_NONE, 0);
	const char *name[3] = {"R", "G", "B"};
	assert_string_equal(readback_attribute(&r, "compression"), compression);
	for (size_t i = 0; i < (size_t)f->width * f->height * 3; i++)
		assert_true(readback_value(&r, (int)(i / 3 % f->width), (int)(i / 3 / f->width), name[i % 3]) ==
			    (double)f->radiance[i]);
	readback_close(&r);
}

static void noise_is_not_squeezed_in_vain(void **state)
{
	(void)state;
	struct frame *f = NULL;
	struct error err;
	assert_int_equal(frame_create(64, 200, 0, &f, &err), STATUS_OK);
	expect_compression(f, "zip");
	uint32_t random = 1;
	for (size_t i = 0; i < (size_t)f->width * f->height * 3; i++) {
		random = random * 1664525u + 1013904223u;
		f->radiance[i] = (float)(random >> 8) * 0x1p-24f;
	}
	expect_compression(f, "rle");
	f->height = 20; // too few rows to try it on some of them
	expect_compression(f, "zip");
	frame_destroy(f);
}

static void half_exr_rounds_to_nearest_and_stays_finite(void **state)
{
	(void)state;
	struct frame *f = make_frame(3, 5, AOV_ALL);
	const float in[9] = {1, 0.1f, 2049, 2051, 65504, 1e6f, -1e30f, 1e-9f, INFINITY};
	// Nearest half, ties to even: 0.1 is 1638.4 · 2^-14, between 2048 and 4096 halves step by 2.
	const double out[9] = {1, 0.0999755859375, 2048, 2052, 65504, 65504, -65504, 0, (double)INFINITY};
	memcpy(f->radiance, in, sizeof in);
	struct readback r = through(f, CODEC_EXR_HALF, CODEC_VIEW_NONE, 0);
	const char *name[3] = {"R", "G", "B"};
	for (int i = 0; i < 3; i++) {
		expect_type(&r, name[i], READBACK_HALF);
		for (int x = 0; x < 3; x++)
			assert_true(readback_value(&r, x, 0, name[i]) == out[3 * x + i]);
	}
	expect_type(&r, "N.X", READBACK_HALF);
	expect_type(&r, "albedo.G", READBACK_HALF);
	expect_type(&r, "Z", READBACK_FLOAT);
	expect_type(&r, "id", READBACK_UINT);
	assert_true(readback_value(&r, 0, 0, "Z") == (double)f->depth[0]);
	assert_true(isinf(readback_value(&r, 1, 0, "Z")));
	assert_true(readback_value(&r, 2, 4, "id") == (double)f->id[14]);
	readback_close(&r);
	frame_destroy(f);
}

static void only_the_aovs_that_were_asked_for_are_written(void **state)
{
	(void)state;
	struct frame *f = make_frame(2, 2, 0);
	struct readback r = through(f, CODEC_EXR_FLOAT, CODEC_VIEW_NONE, 0);
	assert_int_equal(r.channels, 3);
	readback_close(&r);
	frame_destroy(f);
	f = make_frame(2, 2, AOV_DEPTH | AOV_ID);
	r = through(f, CODEC_EXR_HALF, CODEC_VIEW_NONE, 0);
	assert_int_equal(r.channels, 5);
	expect_type(&r, "Z", READBACK_FLOAT);
	expect_type(&r, "id", READBACK_UINT);
	readback_close(&r);
	frame_destroy(f);
}

static void png_has_known_codes(void **state)
{
	(void)state;
	struct frame *f = make_frame(3, 1, AOV_ALL);
	const float in[9] = {0, 0.5f, 1, 2, -1, 0.18f, NAN, INFINITY, 0.0031308f};
	const double out[9] = {0, 188, 255, 255, 0, 118, 0, 255, 10};
	memcpy(f->radiance, in, sizeof in);
	struct readback r = through(f, CODEC_PNG, CODEC_VIEW_NONE, 0);
	assert_int_equal(r.channels, 3);
	const char *name[3] = {"R", "G", "B"};
	for (int i = 0; i < 3; i++) {
		expect_type(&r, name[i], READBACK_UINT8);
		for (int x = 0; x < 3; x++)
			assert_true(readback_value(&r, x, 0, name[i]) == out[3 * x + i]);
	}
	readback_close(&r);
	frame_destroy(f);
}

static void metadata_is_in_the_file(void **state)
{
	(void)state;
	struct frame *f = make_frame(3, 5, 0);
	struct readback r = through(f, CODEC_EXR_HALF, CODEC_VIEW_NONE, 0);
	assert_string_equal(readback_attribute(&r, "candil/technique"), "pt");
	assert_string_equal(readback_attribute(&r, "candil/spp"), "7");
	assert_null(readback_attribute(&r, "candil/view"));
	readback_close(&r);
	r = through(f, CODEC_PNG, CODEC_VIEW_FILMIC, -1.5);
	assert_string_equal(readback_attribute(&r, "candil/technique"), "pt");
	assert_string_equal(readback_attribute(&r, "candil/view"), "filmic");
	assert_string_equal(readback_attribute(&r, "candil/exposure"), "-1.5");
	assert_string_equal(readback_attribute(&r, "oiio:ColorSpace"), "sRGB");
	readback_close(&r);
	frame_destroy(f);
}

static void the_same_frame_gives_the_same_bytes(void **state)
{
	(void)state;
	struct frame *f = make_frame(61, 47, AOV_ALL);
	for (int format = CODEC_EXR_HALF; format <= CODEC_PNG; format++) {
		const void *map[2];
		size_t bytes[2];
		for (int i = 0; i < 2; i++) {
			int fd = -1;
			struct error err;
			assert_int_equal(
			    codec_encode(f, (enum codec_format)format, CODEC_VIEW_NONE, 0, &fd, &bytes[i], &err), STATUS_OK);
			assert_int_equal(memfd_map_sealed(fd, &map[i], &bytes[i], &err), STATUS_OK);
			close(fd);
			// A date in the file would differ now.
			if (i == 0)
				sleep(1);
		}
		assert_int_equal(bytes[0], bytes[1]);
		assert_memory_equal(map[0], map[1], bytes[0]);
		for (int i = 0; i < 2; i++)
			munmap((void *)(uintptr_t)map[i], bytes[i]);
	}
	frame_destroy(f);
}

static void frames_beyond_the_limit_are_refused(void **state)
{
	(void)state;
	struct frame *f = NULL;
	struct error err;
	assert_int_equal(frame_create(0, 5, 0, &f, &err), STATUS_LIMIT);
	assert_int_equal(frame_create(UINT32_MAX, UINT32_MAX, AOV_ALL, &f, &err), STATUS_LIMIT);
	assert_null(f);
	assert_int_equal(frame_create(2, 2, 0, &f, &err), STATUS_OK);
	for (unsigned i = 0; i < 2 * FRAME_METADATA_MAX; i++)
		frame_add_metadata(f, "a key that is longer than its thirty-one bytes", "%0200u", i);
	assert_int_equal(f->metadata_count, FRAME_METADATA_MAX);
	assert_int_equal(strlen(f->metadata[0].key), sizeof f->metadata[0].key - 1);
	char name[] = "stage a";
	for (unsigned i = 0; i < 2 * FRAME_STAGES_MAX; i++, name[6]++)
		frame_add_stage(f, name, i);
	assert_int_equal(f->stage_count, FRAME_STAGES_MAX);
	frame_add_stage(f, "stage c", 40); // grows
	assert_int_equal(f->stage_count, FRAME_STAGES_MAX);
	assert_int_equal(f->stages[2].us, 42);
	frame_destroy(f);
	frame_destroy(NULL);
}

static codec_function *open_codec(struct error *err)
{
	(void)err;
	return codec_encode;
}

static codec_function *open_slowly(struct error *err)
{
	usleep(20000);
	return open_codec(err);
}

static void the_encoder_answers_every_frame_in_order(void **state)
{
	(void)state;
	// More frames than the queue holds, so that submitting has to wait; the socket's buffer holds all the answers.
	enum { FRAMES = 3 * ENCODER_QUEUE_FRAMES };
	int line[2];
	assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, line), 0);
	struct encoder *encoder = NULL;
	struct error err;
	assert_int_equal(encoder_create(line[0], "a device", open_slowly, &encoder, &err), STATUS_OK);
	encoder_prepare(encoder);
	for (uint32_t i = 0; i < FRAMES; i++) {
		struct frame *f = make_frame(16, 9, 0);
		f->samples = i + 1;
		f->rays = 1000 + i;
		f->non_finite_samples = i;
		f->estimate.relmse = 0.25;
		frame_add_stage(f, "trace", 42);
		encoder_submit(encoder, &(struct encoder_task){
					    .job = 100 + i, .final = i % 2, .frame = f, .file = {.format = CODEC_PNG}});
	}
	encoder_destroy(encoder);
	close(line[0]);
	for (uint32_t i = 0; i <= FRAMES; i++) {
		struct ipc_image image;
		size_t bytes;
		int fd;
		assert_int_equal(ipc_receive(line[1], &image, sizeof image, &bytes, &fd, &err), STATUS_OK);
		if (i == FRAMES) {
			assert_int_equal(bytes, 0);
			break;
		}
		assert_int_equal(bytes, sizeof image);
		assert_int_equal(image.head.op, IPC_IMAGE);
		assert_int_equal(image.head.job, 100 + i);
		assert_int_equal(image.error.code, STATUS_OK);
		assert_int_equal(image.frame.final, i % 2);
		assert_int_equal(image.frame.format, candil_Format_FORMAT_PNG);
		assert_int_equal(image.frame.width, 16);
		assert_int_equal(image.frame.height, 9);
		assert_int_equal(image.frame.samples, i + 1);
		assert_int_equal(image.done.samples, i + 1);
		assert_int_equal(image.done.rays, 1000 + i);
		assert_int_equal(image.done.non_finite_samples, i);
		assert_true(image.done.estimated_relmse == 0.25);
		assert_string_equal(image.done.device, "a device");
		// The first has to wait for the codec, and others may have been there by then.
		const bool waited = image.done.stages_count == 4;
		assert_int_equal(image.done.stages_count, waited ? 4 : 3);
		assert_true(waited || i > 0);
		assert_string_equal(image.done.stages[0].name, "trace");
		assert_int_equal(image.done.stages[0].us, 42);
		assert_true(!waited || !strcmp(image.done.stages[1].name, "open"));
		assert_int_equal(image.done.cold_us, waited ? image.done.stages[1].us : 0);
		assert_string_equal(image.done.stages[image.done.stages_count - 2].name, "encoder");
		assert_string_equal(image.done.stages[image.done.stages_count - 1].name, "encode");
		struct readback r = {0};
		assert_int_equal(readback_open(fd, image.frame.bytes, "png", &r), 0);
		assert_int_equal(r.width, 16);
		readback_close(&r);
		close(fd);
	}
	close(line[1]);
}

static codec_function *open_nothing(struct error *err)
{
	error_set(err, STATUS_ENCODE, "there is no codec");
	return NULL;
}

static void without_a_codec_frames_are_answered_by_that(void **state)
{
	(void)state;
	int line[2], fd = -1;
	struct encoder *encoder = NULL;
	struct error err;
	assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, line), 0);
	assert_int_equal(encoder_create(line[0], "a device", open_nothing, &encoder, &err), STATUS_OK);
	encoder_prepare(encoder);
	encoder_submit(encoder,
		       &(struct encoder_task){.job = 7, .frame = make_frame(4, 4, 0), .file = {.format = CODEC_PNG}});
	encoder_destroy(encoder);
	struct ipc_image image;
	size_t bytes = 0;
	assert_int_equal(ipc_receive(line[1], &image, sizeof image, &bytes, &fd, &err), STATUS_OK);
	assert_int_equal(image.head.job, 7);
	assert_int_equal(image.error.code, STATUS_ENCODE);
	assert_string_equal(image.error.text, "there is no codec");
	assert_int_equal(fd, -1);
	close(line[0]);
	close(line[1]);
}

static void the_encoder_outlives_its_peer(void **state)
{
	(void)state;
	int line[2];
	assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, line), 0);
	struct encoder *encoder = NULL;
	struct error err;
	assert_int_equal(encoder_create(line[0], "a device", open_codec, &encoder, &err), STATUS_OK);
	close(line[1]);
	for (uint32_t i = 0; i < 2 * ENCODER_QUEUE_FRAMES; i++)
		encoder_submit(
		    encoder, &(struct encoder_task){.job = i, .frame = make_frame(4, 4, 0), .file = {.format = CODEC_PNG}});
	encoder_destroy(encoder);
	encoder_destroy(NULL);
	close(line[0]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(float_exr_is_exact_at_every_size),
	    cmocka_unit_test(noise_is_not_squeezed_in_vain),
	    cmocka_unit_test(half_exr_rounds_to_nearest_and_stays_finite),
	    cmocka_unit_test(only_the_aovs_that_were_asked_for_are_written),
	    cmocka_unit_test(png_has_known_codes),
	    cmocka_unit_test(metadata_is_in_the_file),
	    cmocka_unit_test(the_same_frame_gives_the_same_bytes),
	    cmocka_unit_test(frames_beyond_the_limit_are_refused),
	    cmocka_unit_test(the_encoder_answers_every_frame_in_order),
	    cmocka_unit_test(without_a_codec_frames_are_answered_by_that),
	    cmocka_unit_test(the_encoder_outlives_its_peer),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
