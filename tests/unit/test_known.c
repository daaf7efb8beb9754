// What the daemon makes of frames and pilots, without a daemon: what is warm, what a slow client, a black picture or a
// technique that cannot leave behind.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "server/front/jobs/table.h"
#include "server/front/peer.h"
#include "server/front/quotes/key.h"
#include "server/front/quotes/known.h"
#include "server/front/session.h"

#define PT candil_Technique_TECHNIQUE_PT
#define VCT candil_Technique_TECHNIQUE_VCT
#define ERROR_KIND candil_ErrorKind_ERROR_KIND_PREDICTED

static struct jobs jobs;
static struct worker worker;
static struct quote_known known;
static struct scene room, hall, shop;
static candil_Render request;

static int set_up(void **state)
{
	struct error err;
	(void)state;
	worker.ready.software = false;
	snprintf(worker.ready.device, sizeof worker.ready.device, "a device");
	request = (candil_Render){.technique = PT, .width = 64, .height = 64, .samples = 4};
	room = (struct scene){.id = 1, .info = {.hash = "room", .facts_count = 1, .facts = {"emitters"}}};
	hall = (struct scene){.id = 2, .info = {.hash = "hall", .facts_count = 1, .facts = {"emitters"}}};
	shop = (struct scene){.id = 3, .info = {.hash = "shop", .facts_count = 1, .facts = {"glass"}}};
	return quote_known_init(&known, &jobs, &worker, "", &err) == STATUS_OK ? 0 : -1;
}

static int tear_down(void **state)
{
	(void)state;
	quote_known_finish(&known);
	return 0;
}

static struct rendered of(struct scene *scene)
{
	static struct subject subjects[4]; // by scene
	struct subject *subject = &subjects[scene->id];
	subject->part[PART_SCENE] = scene;
	return (struct rendered){.subject = subject, .render = &request, .alone = true, .worker = worker.starts};
}

static void add_stage(candil_Done *done, const char *name, uint64_t us)
{
	candil_Stage *stage = &done->stages[done->stages_count++];
	snprintf(stage->name, sizeof stage->name, "%s", name);
	stage->us = us;
	done->elapsed_us += us;
}

static void render_slowed(struct scene *scene, uint64_t compile_us, uint64_t send_us, uint64_t times, bool slowed)
{
	candil_Done done = {.samples = 4};
	struct rendered f = of(scene);
	f.slowed = slowed;
	add_stage(&done, "compile", compile_us);
	add_stage(&done, "upload", 9000 * times);
	add_stage(&done, "path", 40000 * times);
	add_stage(&done, "encode", 3000 * times);
	add_stage(&done, "send", send_us);
	f.done = &done;
	jobs.rendered(jobs.owner, &f);
}

static void render(struct scene *scene, uint64_t compile_us, uint64_t send_us)
{
	render_slowed(scene, compile_us, send_us, 1, false);
}

static struct quote_query ask(struct scene *scene, candil_Technique technique)
{
	const struct rendered f = of(scene);
	return quote_known_query(&known, &f, technique, 4, NULL);
}

static void look(struct scene *scene, candil_Technique technique, uint32_t pixels, struct estimate error)
{
	const struct rendered f = of(scene);
	const struct pilot_result result = {
	    .pixels = pixels, .samples = pixels ? 4 : 0, .cold_us = 100, .pixel_us = 10, .sample_us = 900, .error = error};
	quote_known_pilot(&known, &f, technique, &result);
}

static void programs_are_those_of_scenes_with_the_same_facts(void **state)
{
	(void)state;
	struct quote_query q = ask(&room, PT);
	assert_true(q.cold && q.setup);
	render(&room, 2000000, 100);
	q = ask(&room, PT);
	assert_true(!q.cold && !q.setup);
	q = ask(&hall, PT);
	assert_true(!q.cold && q.setup);
	q = ask(&shop, PT);
	assert_true(q.cold && q.setup);
	assert_true(ask(&room, VCT).cold);
	const struct rendered in_hall = of(&hall);
	assert_false(quote_known_warm(&known, &in_hall, &q.key));
}

static void what_did_not_have_to_be_compiled_is_remembered(void **state)
{
	(void)state;
	render(&room, 0, 100);
	known.warm_count = 0; // the worker is another
	const struct quote_query q = ask(&room, PT);
	assert_true(q.cold);
	assert_true(quote_predict(known.model, &q).cold_us < 20000);
}

static void who_compiles_beside_a_frame_does_not_make_the_device_slow(void **state)
{
	(void)state;
	render(&room, 0, 100);
	const struct quote_query q = ask(&room, PT);
	const struct quote_prediction before = quote_predict(known.model, &q);
	for (int i = 0; i < 5; i++)
		render_slowed(&room, 0, 100, 10, true);
	const struct quote_prediction after = quote_predict(known.model, &q);
	assert_true(after.us == before.us && after.us_high == before.us_high);
	render_slowed(&room, 0, 100, 10, false);
	assert_true(quote_predict(known.model, &q).us > 1.5 * before.us);
}

static void a_client_that_reads_slowly_does_not_make_files_dear(void **state)
{
	(void)state;
	render(&room, 0, 1000);
	struct quote_query q = ask(&room, PT);
	const double quick = quote_predict(known.model, &q).us;
	for (int i = 0; i < 3; i++)
		render(&hall, 0, 9000000);
	q = ask(&hall, PT);
	assert_true(quote_predict(known.model, &q).us < 1.5 * quick);
}

static void send(uint64_t us)
{
	candil_Done done = {.samples = 4};
	struct rendered f = of(&room);
	add_stage(&done, "path", 40000);
	add_stage(&done, "encode", 3000);
	add_stage(&done, "send", us);
	f.done = &done;
	jobs.rendered(jobs.owner, &f);
}

static void a_client_that_reads_slowly_does_not_widen_intervals(void **state)
{
	(void)state;
	for (int i = 0; i < 20; i++)
		send(3000);
	const struct quote_query q = ask(&room, PT);
	const struct quote_prediction before = quote_predict(known.model, &q);
	for (int i = 0; i < 8; i++)
		send(9000000);
	const struct quote_prediction after = quote_predict(known.model, &q);
	assert_true(log(after.us_high / after.us) < 1.05 * log(before.us_high / before.us));
}

static void programs_that_were_there_do_not_make_compiling_cheap(void **state)
{
	(void)state;
	request.options_count = 1;
	snprintf(request.options[0].name, sizeof request.options[0].name, "pt.depth");
	render(&room, 2000000, 100);
	// Of other options, whose programs are the same.
	snprintf(request.options[0].value, sizeof request.options[0].value, "7");
	assert_true(ask(&room, PT).cold);
	render(&room, 0, 100);
	known.warm_count = 0; // the worker is another
	const struct quote_query q = ask(&room, PT);
	assert_true(quote_predict(known.model, &q).cold_us > 1000000);
}

static void a_frame_of_a_worker_that_is_gone_makes_nothing_warm(void **state)
{
	candil_Done done = {.samples = 4};
	struct rendered f = of(&room);
	(void)state;
	add_stage(&done, "path", 40000);
	f.done = &done;
	worker.starts++;
	jobs.rendered(jobs.owner, &f);
	assert_true(ask(&room, PT).cold);
	f.worker = worker.starts;
	jobs.rendered(jobs.owner, &f);
	assert_false(ask(&room, PT).cold);
}

static void times_of_a_picture_that_compiled_are_no_rate(void **state)
{
	const struct rendered f = of(&room);
	struct pilot_result result = {.pixels = 256, .samples = 1, .cold_us = 2000000, .setup_us = 50, .sample_us = 900000};
	struct quote_query q = ask(&room, VCT);
	(void)state;
	const double before = quote_predict(known.model, &q).us;
	result.slowed = 1;
	result.error = ESTIMATE_UNKNOWN;
	quote_known_pilot(&known, &f, VCT, &result);
	struct quote_prediction said = quote_predict(known.model, &q);
	assert_true(said.us <= before && said.cold_us > 1500000);
	assert_int_equal(quote_known_refused(&known, &f), 0);
	result.slowed = 0;
	quote_known_pilot(&known, &f, VCT, &result);
	assert_true(quote_predict(known.model, &q).us > 10 * before);
}

// A pilot of the room by vct, which has seen these two biases.
static void look_for_bias(const struct pilot_bias bias[2])
{
	const struct rendered f = of(&room);
	const struct pilot_result result = {
	    .pixels = 4096, .samples = 1, .sample_us = 9000, .error = ESTIMATE_UNKNOWN, .bias = {bias[0], bias[1]}};
	quote_known_pilot(&known, &f, VCT, &result);
}

static void the_bias_of_few_samples_is_more_than_that_of_many(void **state)
{
	const struct rendered f = of(&room);
	(void)state;
	// Of a village seen from afar, measured.
	look_for_bias((const struct pilot_bias[]){{1024, 4, 0, {0.021, 0.018, 0.024, ERROR_KIND}},
						  {1024, 1, 0, {0.0585, 0.053, 0.064, ERROR_KIND}}});
	struct quote_query q = ask(&room, VCT);
	q.samples = 4;
	struct estimate e = quote_predict(known.model, &q).error;
	assert_true(e.low < 0.021 && 0.021 < e.high && e.relmse < 1.25 * 0.021);
	q.samples = 1;
	e = quote_predict(known.model, &q).error;
	assert_true(e.low < 0.0585 && 0.0585 < e.high && e.relmse > 0.0585 / 1.25);
	// Of how many more would be left nothing is known but that it may be less.
	q.samples = 16;
	assert_true(quote_predict(known.model, &q).error.low < 0.01);
	assert_int_equal(quote_known_refused(&known, &f), 0);
}

static void edges_are_fewer_in_larger_pictures(void **state)
{
	(void)state;
	look_for_bias((const struct pilot_bias[]){{1024, 4, 0.5, {0.02, 0.018, 0.022, ERROR_KIND}},
						  {1024, 1, 0.8, {0.05, 0.047, 0.053, ERROR_KIND}}});
	struct quote_query q = ask(&room, VCT);
	// 0.01 is bias; of what is left a picture twice as wide has half.
	for (int wide = 0; wide < 2; wide++) {
		q.samples = 1;
		q.pixels = wide ? 4096 : 1024;
		const double one = quote_predict(known.model, &q).error.relmse, expected = wide ? 0.03 : 0.05;
		assert_true(fabs(log(one / expected)) < 0.15);
	}
	// Sixteen samples leave a sixteenth of it.
	q.samples = 16;
	const double many = quote_predict(known.model, &q).error.relmse;
	assert_true(many < 0.02 && many > 0.005);
}

static void a_view_that_was_looked_at_is_not_looked_at_again(void **state)
{
	struct quote_query q = ask(&room, VCT);
	(void)state;
	assert_int_equal(quote_count_view(known.model, &q.key, QUOTE_ERROR), 0);
	look(&room, VCT, 1024, ESTIMATE_UNKNOWN);
	assert_int_equal(quote_count_view(known.model, &q.key, QUOTE_ERROR), 1);
	// A frame that could not tell its error is no look.
	render(&hall, 0, 100);
	q = ask(&hall, PT);
	assert_int_equal(quote_count_view(known.model, &q.key, QUOTE_ERROR), 0);
}

static void an_error_that_may_be_far_higher_is_expected_to_be_higher(void **state)
{
	const candil_ErrorKind kind = candil_ErrorKind_ERROR_KIND_MEASURED;
	(void)state;
	look(&room, PT, 1024, (struct estimate){0.03, 0.02, 0.045, kind});
	struct quote_query q = ask(&room, PT);
	const struct estimate even = quote_predict(known.model, &q).error;
	tear_down(state);
	set_up(state);
	look(&room, PT, 1024, (struct estimate){0.03, 0.02, 0.1, kind});
	q = ask(&room, PT);
	const struct estimate skewed = quote_predict(known.model, &q).error;
	assert_true(skewed.relmse > 1.3 * even.relmse && skewed.high > 1.5 * even.high && skewed.low < 1.3 * even.low);
}

static void a_black_picture_has_no_error_and_says_nothing_of_others(void **state)
{
	(void)state;
	look(&room, PT, 1024, (struct estimate){0, 0, 0, candil_ErrorKind_ERROR_KIND_MEASURED});
	struct quote_query q = ask(&room, PT);
	assert_true(quote_predict(known.model, &q).error.high < 1e-9);
	q = ask(&hall, PT);
	assert_true(quote_predict(known.model, &q).error.relmse > 0.01);
}

// ---- work that is made once for a scene
// ------------------------------------------------------------------------------------

#define RADIOSITY candil_Technique_TECHNIQUE_RADIOSITY

// So many rows are left, and so many took 2 µs each.
static struct work rows(double left, double made)
{
	return (struct work){.told = WORK_KEPT,
			     .way_of_rows = 5,
			     .way_of_pictures = 6,
			     .picture = 2,
			     .left = {[WORK_ROWS] = left},
			     .doubt = {[WORK_ROWS] = 0.1},
			     .made = {[WORK_ROWS] = made},
			     .us = {[WORK_ROWS] = 2 * made}};
}

static void render_radiosity(struct scene *scene, candil_Format format, double made)
{
	candil_Done done = {.samples = 4};
	const struct work work = rows(0, made);
	struct rendered f = of(scene);
	request.technique = RADIOSITY;
	request.format = format;
	add_stage(&done, "upload", 5000);
	add_stage(&done, "factors", (uint64_t)(2 * made));
	add_stage(&done, "lookup", 40000);
	add_stage(&done, "encode", 3000);
	f.done = &done;
	f.work = &work;
	jobs.rendered(jobs.owner, &f);
	request.format = candil_Format_FORMAT_EXR_HALF;
}

static double predicted_us(struct scene *scene, const struct work *work)
{
	const struct rendered f = of(scene);
	const struct quote_query q = quote_known_query(&known, &f, RADIOSITY, 4, work);
	return quote_predict(known.model, &q).us;
}

static void what_is_left_of_the_work_is_told_by_the_worker(void **state)
{
	(void)state;
	worker.ready.software = true;
	const struct work all = rows(500000, 0), none = rows(0, 0);
	render_radiosity(&room, candil_Format_FORMAT_EXR_HALF, 500000);
	const double picture = predicted_us(&room, &none), whole = predicted_us(&room, &all);
	assert_true(picture < 100000);
	assert_true(fabs(log((whole - picture) / 1e6)) < 0.25);
	// Rows are no part of what else is made once: of a scene that is new that is little.
	assert_true(predicted_us(&hall, &none) < 300000);
	assert_true(predicted_us(&hall, &all) > 600000);
	// Until it tells anew, what it told last holds, or else it may be anything.
	assert_true(fabs(log(predicted_us(&room, NULL) / picture)) < 0.01);
	const struct rendered in_hall = of(&hall);
	const struct quote_query q = quote_known_query(&known, &in_hall, RADIOSITY, 4, NULL);
	const struct quote_prediction p = quote_predict(known.model, &q);
	assert_true(p.us_high > 10 * p.us && p.us > 5 * picture);
	worker.starts++; // it is another
	assert_true(predicted_us(&room, NULL) > 5 * picture);
}

static void what_was_tried_is_known_better_than_what_is_counted(void **state)
{
	const struct rendered f = of(&room);
	struct work tried = rows(500000, 1000), counted = rows(300000, 0), none = rows(0, 0);
	(void)state;
	tried.told = WORK_TRIED;
	counted.told = WORK_COUNTED;
	assert_true(quote_known_told(&known, &f, RADIOSITY, &counted).left[WORK_ROWS] < 300001);
	assert_true(quote_known_told(&known, &f, RADIOSITY, &tried).left[WORK_ROWS] > 499999);
	assert_true(quote_known_told(&known, &f, RADIOSITY, &counted).left[WORK_ROWS] > 499999);
	// Not once it was there, and is gone.
	assert_true(quote_known_told(&known, &f, RADIOSITY, &none).left[WORK_ROWS] < 1);
	assert_true(quote_known_told(&known, &f, RADIOSITY, &counted).left[WORK_ROWS] < 300001);
	worker.starts++;
	assert_true(quote_known_told(&known, &f, RADIOSITY, &counted).left[WORK_ROWS] < 300001);
}

static void files_and_pilots_tell_of_rows(void **state)
{
	const struct rendered f = of(&room);
	const struct work all = rows(500000, 0);
	struct pilot_result tried = {.work = rows(500000, 1000), .error = ESTIMATE_UNKNOWN};
	(void)state;
	quote_known_pilot(&known, &f, RADIOSITY, &tried);
	assert_int_equal(quote_known_refused(&known, &f), 0);
	assert_true(fabs(log(predicted_us(&room, &all) / 1e6)) < 0.5);
	// What was counted alone is no record, and no refusal either.
	const uint32_t records = known.model->count;
	tried.work = rows(500000, 0);
	quote_known_pilot(&known, &f, RADIOSITY, &tried);
	assert_int_equal(known.model->count, records);
	assert_int_equal(quote_known_refused(&known, &f), 0);
	render_radiosity(&hall, candil_Format_FORMAT_PLY, 500000);
	assert_int_equal(known.model->count, records + 1);
	assert_true(fabs(log(predicted_us(&hall, &all) / 1e6)) < 0.5);
	// A file makes nothing warm that a picture needs.
	assert_true(ask(&hall, RADIOSITY).setup && ask(&hall, RADIOSITY).cold);
}

static void samples_of_pictures_count_as_many_rays(void **state)
{
	const struct rendered f = of(&room);
	struct work gathered = rows(0, 0);
	(void)state;
	render_radiosity(&room, candil_Format_FORMAT_EXR_HALF, 0);
	struct quote_query q = quote_known_query(&known, &f, RADIOSITY, 4, &gathered);
	const double two = quote_predict(known.model, &q).us;
	gathered.picture = 16;
	q = quote_known_query(&known, &f, RADIOSITY, 4, &gathered);
	assert_true(quote_predict(known.model, &q).us > two + 0.75 * 7 * 40000);
}

static void a_technique_that_could_not_is_remembered_until_it_can(void **state)
{
	const struct rendered in_room = of(&room), in_hall = of(&hall);
	(void)state;
	assert_int_equal(quote_known_refused(&known, &in_room), 0);
	look(&room, PT, 0, ESTIMATE_UNKNOWN);
	assert_int_equal(quote_known_refused(&known, &in_room), 1u << PT);
	assert_int_equal(quote_known_refused(&known, &in_hall), 0);
	const struct quote_query q = ask(&room, PT);
	assert_int_equal(quote_predict(known.model, &q).records, 0);
	assert_true(isfinite(quote_predict(known.model, &q).us));
	render(&room, 0, 100);
	assert_int_equal(quote_known_refused(&known, &in_room), 0);
}

static void a_job_that_waits_for_a_pilot_is_not_alone(void **state)
{
	struct peer peer = {0};
	struct session session = {.peer = &peer};
	struct job job = {.state = JOB_ACTIVE, .deadline_us = UINT64_MAX, .end_us = UINT64_MAX, .session = &session};
	(void)state;
	jobs = (struct jobs){.worker = &worker, .job = {&job}, .count = 1, .piloting = true, .stepping = 1};
	worker.state = WORKER_READY;
	jobs_dispatch(&jobs);
	assert_true(job.crowded);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
	const struct CMUnitTest tests[] = {
	    TEST(programs_are_those_of_scenes_with_the_same_facts),
	    TEST(what_did_not_have_to_be_compiled_is_remembered),
	    TEST(who_compiles_beside_a_frame_does_not_make_the_device_slow),
	    TEST(a_client_that_reads_slowly_does_not_make_files_dear),
	    TEST(a_client_that_reads_slowly_does_not_widen_intervals),
	    TEST(programs_that_were_there_do_not_make_compiling_cheap),
	    TEST(a_frame_of_a_worker_that_is_gone_makes_nothing_warm),
	    TEST(times_of_a_picture_that_compiled_are_no_rate),
	    TEST(the_bias_of_few_samples_is_more_than_that_of_many),
	    TEST(edges_are_fewer_in_larger_pictures),
	    TEST(a_view_that_was_looked_at_is_not_looked_at_again),
	    TEST(an_error_that_may_be_far_higher_is_expected_to_be_higher),
	    TEST(a_black_picture_has_no_error_and_says_nothing_of_others),
	    TEST(a_job_that_waits_for_a_pilot_is_not_alone),
	    TEST(what_is_left_of_the_work_is_told_by_the_worker),
	    TEST(what_was_tried_is_known_better_than_what_is_counted),
	    TEST(files_and_pilots_tell_of_rows),
	    TEST(samples_of_pictures_count_as_many_rays),
	    TEST(a_technique_that_could_not_is_remembered_until_it_can),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
