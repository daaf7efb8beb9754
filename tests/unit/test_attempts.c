// Attempts at a picture under a deadline, by a stand-in for a technique and a clock of their own: a step takes as long as
// its tiles cost.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "protocol/header.h"
#include "server/worker/attempts.h"
#include "server/worker/devices.h"
#include "server/worker/image/scale.h"
#include "server/worker/plan/plan.h"
#include "server/worker/vk/device.h"

uint64_t __wrap_clock_us(void);

#define TILE 64u // pixels
#define START 1000000u

static double now;
static double tile_us, fixed_us, setup_us, begin_us; // what things take; fixed_us: a sample, whatever its pixels are
static double dearer; // what tiles take in an attempt for which the forecast is wrong, of the others'
static unsigned begun, refuse; // attempts, and how many of them get no memory
static double target; // that the latest attempt was given

uint64_t __wrap_clock_us(void)
{
	return (uint64_t)now;
}

struct technique_job {
	struct plan plan;
	double setup_us; // left
	uint32_t tiles, tile, sample;
	double dearer;
	double work_us;
};

static enum status stand_in_begin(struct devices *devices, struct resident_scene *scene, const struct plan *plan,
				  struct technique_job **job, struct error *err)
{
	(void)devices;
	(void)scene;
	now += begin_us;
	if (refuse > 0 && begun > 0 && refuse--)
		return error_set(err, STATUS_MEMORY, "none");
	*job = calloc(1, sizeof **job);
	assert_non_null(*job);
	(*job)->plan = *plan;
	(*job)->setup_us = begun++ == 0 ? setup_us : 0;
	(*job)->tiles = ((plan->width + 7) / 8) * ((plan->height + 7) / 8);
	target = plan->target_error;
	(*job)->dearer = begun > 3 ? dearer : 1;
	return STATUS_OK;
}

static bool is_late(const struct technique_job *j)
{
	return (j->sample > 0 || !j->plan.first_sure) && !plan_fits(&j->plan, (uint64_t)now, tile_us);
}

// As pt does it: as many tiles as fit the piece, one at least.
static enum status stand_in_step(struct technique_job *j, uint32_t budget_us, struct step_result *result, struct error *err)
{
	(void)err;
	if (j->setup_us > 0) {
		const double us = fmin(j->setup_us, budget_us);
		now += us;
		j->setup_us -= us;
		return STATUS_OK;
	}
	const double until = now + budget_us;
	while (now < until && j->sample < j->plan.samples && !is_late(j)) {
		if (j->tile == 0) {
			now += fixed_us;
			j->work_us += fixed_us;
		}
		const double piece_us = plan_piece_us(&j->plan, (uint64_t)now, until - now);
		const uint32_t left = j->tiles - j->tile;
		const uint32_t tiles = piece_us < tile_us          ? 1
				       : piece_us / tile_us < left ? (uint32_t)(piece_us / tile_us)
								   : left;
		now += tiles * tile_us * j->dearer;
		j->work_us += tiles * tile_us * j->dearer;
		j->tile += tiles;
		if (j->tile < j->tiles)
			continue;
		j->tile = 0;
		if (j->sample++ == 0)
			break;
	}
	result->drawing = true;
	result->samples_done = j->sample;
	result->sample_us = j->sample > 0 ? j->work_us / j->sample : 0;
	result->finished = j->sample == j->plan.samples;
	result->late = !result->finished && is_late(j);
	result->estimate.relmse = 1;
	result->fraction = 0.5;
	return STATUS_OK;
}

static enum status stand_in_read(struct technique_job *j, struct frame **frame, struct error *err)
{
	const enum status s = frame_create(j->plan.width, j->plan.height, j->plan.aovs, frame, err);
	for (uint32_t i = 0; s == STATUS_OK && i < j->plan.width * j->plan.height; i++) {
		const uint32_t x = i % j->plan.width, y = i / j->plan.width;
		const bool done = j->sample > 0 || y / 8 * ((j->plan.width + 7) / 8) + x / 8 < j->tile;
		for (unsigned c = 0; c < 3; c++)
			(*frame)->radiance[3 * i + c] = done ? 2.5f : 0;
	}
	if (s == STATUS_OK) {
		(*frame)->ahead = j->sample == 0 ? j->tile : 0;
		(*frame)->samples = j->sample;
		frame_add_stage(*frame, "compile", 7);
		frame_add_stage(*frame, "trace", (uint64_t)j->work_us);
	}
	return s;
}

static void stand_in_end(struct technique_job *j)
{
	free(j);
}

static const struct technique stand_in = {
    .sides_are_code = true, .begin = stand_in_begin, .step = stand_in_step, .read = stand_in_read, .end = stand_in_end};

struct outcome {
	struct step_result last;
	bool ready;
	uint32_t width, height, samples; // made; 0: no picture
	double over_us; // past the end
	uint64_t compile_us, size_us;
	bool patched; // partly of more pixels
};

// Render until it is over.
static struct outcome render(const struct plan *plan, bool software)
{
	static struct device device;
	struct devices devices = {.vk = &device};
	struct attempts attempts;
	struct outcome out = {0};
	struct error err;
	struct frame *f;
	device.info.software = software;
	now = START;
	begun = 0;
	attempts_init(&attempts, &stand_in, &devices, NULL, plan);
	assert_int_equal(attempts_begin(&attempts, &err), STATUS_OK);
	do {
		out.last = STEP_RESULT_NOTHING;
		// The front sizes slices to what is left (jobs/deadline.c).
		const double left = (double)plan->end_us - now;
		const uint32_t slice = left > 1000 && left < 50000 ? (uint32_t)left
				       : left > 0 && left <= 1000  ? 1000
								   : 50000;
		enum status s = attempts_step(&attempts, slice, &out.last, &err);
		if (s == STATUS_MEMORY)
			s = attempts_step(&attempts, slice, &out.last, &err);
		assert_int_equal(s, STATUS_OK);
		assert_true(out.last.samples_done == 0 || attempts_ready(&attempts));
		assert_true(out.last.late || out.last.finished || plan->end_us == 0 || (double)plan->end_us > now ||
			    (!plan->whole && !attempts_ready(&attempts)));
	} while (!out.last.late && !out.last.finished);
	out.over_us = now - (double)plan->end_us;
	out.ready = attempts_ready(&attempts);
	if (out.ready) {
		assert_int_equal(attempts_read(&attempts, &f, &err), STATUS_OK);
		assert_int_equal(f->width, plan->width);
		assert_int_equal(f->height, plan->height);
		for (uint32_t i = 0; i < 3 * f->width * f->height; i++)
			assert_true(f->radiance[i] == 2.5f);
		const bool scaled = f->made_width != f->width || f->made_height != f->height;
		assert_true(scaled ? f->note_count > 0 : f->note_count == 0);
		out.patched = f->note_count > 1;
		char told[64];
		snprintf(told, sizeof told, "time for %u x %u pixels alone", f->made_width, f->made_height);
		assert_true(!scaled || strstr(f->notes[f->note_count - 1], told));
		assert_true(!scaled || f->estimate.relmse < 0);
		out.width = f->made_width;
		out.height = f->made_height;
		out.samples = f->samples;
		for (uint32_t i = 0; i < f->stage_count; i++)
			*(strcmp(f->stages[i].name, "size") == 0 ? &out.size_us : &out.compile_us) += f->stages[i].us;
		frame_destroy(f);
	}
	attempts_end(&attempts);
	return out;
}

static struct plan plan_of(uint32_t width, uint32_t height, double left_us)
{
	return (struct plan){.width = width,
			     .height = height,
			     .samples = 1u << 20,
			     .deadline = left_us > 0,
			     .end_us = left_us > 0 ? START + (uint64_t)left_us : 0};
}

static void costs(double tile, double setup, double begin)
{
	tile_us = tile;
	fixed_us = 0;
	setup_us = setup;
	begin_us = begin;
	refuse = 0;
	dearer = 1;
}

static void test_without_a_deadline_there_is_one(void **state)
{
	(void)state;
	struct plan plan = plan_of(640, 360, 0);
	plan.samples = 3;
	plan.target_error = 0.5;
	costs(100, 1000, 10);
	const struct outcome o = render(&plan, true);
	assert_true(o.width == 640 && o.height == 360 && o.samples == 3 && o.last.finished);
	assert_true(begun == 1 && target == 0.5 && o.size_us == 0);
}

static void test_with_time_it_is_whole(void **state)
{
	(void)state;
	const struct plan plan = plan_of(640, 360, 10e6);
	costs(100, 1000, 10);
	const struct outcome o = render(&plan, true);
	assert_true(o.width == 640 && o.height == 360 && o.last.late && !o.last.finished);
	// 3600 tiles of 100 µs: all of the time but what was spent on finding the size.
	assert_true(o.samples >= 26 && o.samples <= 27);
	assert_true(o.size_us > 0 && o.size_us < 50000);
}

static void test_without_it_is_scaled(void **state)
{
	(void)state;
	const struct plan plan = plan_of(640, 360, 100e3); // a whole sample takes 360 ms
	costs(100, 1000, 10);
	const struct outcome o = render(&plan, true);
	assert_true(o.last.late && o.ready && o.samples >= 1);
	// Nearly half of the time went into the picture's first sample.
	assert_true((double)o.width * o.height / TILE * tile_us > 45e3);
	assert_true(fabs((double)o.width / o.height - 640.0 / 360) < 0.05);
}

static void test_what_fits_is_whole(void **state)
{
	(void)state;
	struct plan plan = plan_of(640, 360, 550e3); // a sample takes 360 ms
	costs(100, 1000, 10);
	assert_int_equal(render(&plan, true).width, 640);
	plan = plan_of(512, 512, 600e3); // 410 ms
	assert_int_equal(render(&plan, true).width, 512);
	// Where most of a sample is the same for all sizes: triangles that are drawn, or a device's own pace.
	plan = plan_of(512, 512, 250e3);
	costs(2, 1000, 10);
	fixed_us = 50e3;
	assert_int_equal(render(&plan, true).width, 512);
	plan = plan_of(1920, 1080, 20e3);
	costs(0.15, 0, 10);
	fixed_us = 1e3;
	assert_int_equal(render(&plan, false).width, 1920);
}

static void test_the_first_is_shown_at_worst(void **state)
{
	(void)state;
	const struct plan plan = plan_of(640, 360, 1);
	costs(1000, 0, 10);
	const struct outcome o = render(&plan, true);
	assert_true(o.ready && o.width * o.height <= 2 * TILE && o.samples == 1);
}

static void test_what_is_made_of_the_scene_must_be_there(void **state)
{
	(void)state;
	const struct plan plan = plan_of(640, 360, 100e3);
	costs(10, 300e3, 10);
	const struct outcome o = render(&plan, true);
	assert_true(o.last.late && !o.ready && o.over_us <= 1000);
}

static void test_whole_or_nothing(void **state)
{
	(void)state;
	struct plan plan = plan_of(640, 360, 100e3);
	plan.whole = true;
	costs(100, 1000, 10);
	struct outcome o = render(&plan, true);
	assert_true(o.last.late && !o.ready && o.over_us <= tile_us && begun == 1);
	plan = plan_of(640, 360, 500e3);
	plan.whole = true;
	o = render(&plan, true);
	assert_true(o.last.late && o.ready && o.width == 640 && o.samples == 1 && begun == 1);
}

static void test_a_target_is_the_whole_pictures(void **state)
{
	(void)state;
	struct plan plan = plan_of(640, 360, 100e3);
	plan.target_error = 0.25;
	costs(100, 0, 10);
	assert_true(render(&plan, true).width < 640);
	assert_true(target == 0);
	plan.end_us = START + 10000000;
	assert_true(render(&plan, true).width == 640);
	assert_true(target == 0.25);
}

static void test_all_samples_of_fewer_pixels_are_not_all(void **state)
{
	(void)state;
	struct plan plan = plan_of(640, 360, 100e3);
	plan.samples = 1;
	costs(100, 0, 10);
	const struct outcome o = render(&plan, true);
	assert_true(o.width < 640 && o.last.late && !o.last.finished);
}

static void test_what_gets_no_memory_is_begun_again(void **state)
{
	(void)state;
	const struct plan plan = plan_of(640, 360, 10e6);
	costs(100, 0, 10);
	refuse = 1;
	assert_true(render(&plan, true).width == 640);
}

// A software driver compiles code anew for textures whose sides are powers of two where those before were none.
static void test_sizes_need_no_code_of_their_own(void **state)
{
	(void)state;
	static const uint32_t sides[] = {512, 500, 511, 64, 33, 1, 4096};
	for (unsigned i = 0; i < sizeof sides / sizeof *sides; i++)
		for (double left = 1; left < 1e7; left *= 3) {
			const uint32_t n = sides[i];
			const struct plan plan = plan_of(n, 300, left);
			costs(50, 0, 10);
			const uint32_t m = render(&plan, true).width;
			assert_true(m >= 1 && m <= n);
			assert_int_equal((m & (m - 1)) == 0, (n & (n - 1)) == 0);
			const uint32_t m2 = (m + 1) / 2, n2 = (n + 1) / 2;
			assert_int_equal((m2 & (m2 - 1)) == 0, (n2 & (n2 - 1)) == 0);
		}
}

// Whatever things cost: a picture comes, and its end is not missed by more than a tile's time, or the first picture's.
static void test_no_overrun(void **state)
{
	(void)state;
	unsigned scaled = 0, whole = 0, patched = 0;
	srand(1);
	for (unsigned i = 0; i < 1000; i++) {
		const uint32_t width = 1 + (uint32_t)rand() % 300, height = 1 + (uint32_t)rand() % 300;
		const double left = exp(rand() * 13.0 / RAND_MAX);
		const struct plan plan = plan_of(width, height, left);
		costs(exp(1 + rand() * 8.0 / RAND_MAX), 0, rand() % 2 ? 0 : 20);
		dearer = rand() % 2 ? 1 : 3;
		fixed_us = rand() % 2 ? 0 : exp(rand() * 9.0 / RAND_MAX);
		const struct outcome o = render(&plan, i % 2);
		assert_true(o.ready);
		// On a software device the first picture may have up to four times a tile's pixels: of sizes that fit.
		const double first = fmax(left, begin_us + fixed_us + 10 * tile_us) - left;
		assert_true(dearer > 1 || o.over_us <= first + fixed_us + tile_us + begin_us + 1);
		scaled += o.width < width;
		patched += o.patched;
		whole += o.width == width && o.height == height;
	}
	assert_true(scaled > 150 && whole > 150 && patched > 20);
}

// ---- scaling ------------------------------------------------------------------------------------------------------------

static void test_scaling(void **state)
{
	(void)state;
	struct frame *f;
	struct error err;
	assert_int_equal(frame_create(4, 2, AOV_DEPTH | AOV_ID, &f, &err), STATUS_OK);
	for (unsigned i = 0; i < 8; i++) {
		for (unsigned c = 0; c < 3; c++)
			f->radiance[3 * i + c] = (float)(i % 4 + 10 * c);
		f->depth[i] = i == 3 ? INFINITY : 1;
		f->id[i] = i + 1;
		f->met[i] = i != 3;
	}
	assert_int_equal(frame_scale(f, 20, 7, &err), STATUS_OK);
	assert_true(f->width == 20 && f->height == 7 && f->made_width == 4 && f->made_height == 2 && !f->normal &&
		    !f->albedo);
	for (unsigned y = 0; y < 7; y++)
		for (unsigned x = 0; x < 20; x++) {
			const unsigned i = 20 * y + x, nearest = (2 * y + 1) * 2 / 14 * 4 + (2 * x + 1) * 4 / 40;
			// A ramp stays one between the outermost centres.
			const double ramp = fmin(fmax((x + 0.5) / 5 - 0.5, 0), 3);
			for (unsigned c = 0; c < 3; c++)
				assert_true(fabs((double)f->radiance[3 * i + c] - ramp - 10 * c) < 1e-5);
			assert_int_equal(f->id[i], nearest + 1);
			assert_int_equal(f->met[i], nearest != 3);
			assert_true(isinf(f->depth[i]) == (nearest == 3));
		}
	frame_destroy(f);
	assert_int_equal(frame_create(1, 1, 0, &f, &err), STATUS_OK);
	f->radiance[1] = 3;
	assert_int_equal(frame_scale(f, 3, 2, &err), STATUS_OK);
	for (unsigned i = 0; i < 6; i++)
		assert_true(f->radiance[3 * i + 1] == 3);
	frame_destroy(f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_without_a_deadline_there_is_one),
	    cmocka_unit_test(test_with_time_it_is_whole),
	    cmocka_unit_test(test_without_it_is_scaled),
	    cmocka_unit_test(test_what_fits_is_whole),
	    cmocka_unit_test(test_the_first_is_shown_at_worst),
	    cmocka_unit_test(test_what_is_made_of_the_scene_must_be_there),
	    cmocka_unit_test(test_whole_or_nothing),
	    cmocka_unit_test(test_a_target_is_the_whole_pictures),
	    cmocka_unit_test(test_all_samples_of_fewer_pixels_are_not_all),
	    cmocka_unit_test(test_what_gets_no_memory_is_begun_again),
	    cmocka_unit_test(test_sizes_need_no_code_of_their_own),
	    cmocka_unit_test(test_no_overrun),
	    cmocka_unit_test(test_scaling),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
