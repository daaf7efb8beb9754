// The model of quotes, its file, and the choice, without a daemon: what frames told comes back at other sizes and samples,
// what is not known is wide, intervals learn, no file harms, and the best way is chosen.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/front/quotes/choose.h"
#include "server/front/quotes/key.h"
#include "server/front/quotes/store.h"

#define PT candil_Technique_TECHNIQUE_PT
#define DIRECT candil_Technique_TECHNIQUE_DIRECT
#define NEAR(a, b, factor) assert_true((a) <= (b) * (factor) && (b) <= (a) * (factor))

static struct quote_query query(uint64_t scene, uint64_t view, uint32_t technique, double pixels, double samples)
{
	return (struct quote_query){.key = {.where = 1, .scene = scene, .look = technique, .view = view},
				    .technique = technique,
				    .software = true,
				    .pixels = pixels,
				    .samples = samples,
				    .bytes = pixels * 12};
}

// A frame of a machine on which a sample takes 2 µs, a pixel 0.5, a byte 0.01, a frame 1000, and relMSE is 0.8 / samples.
static double true_us(double pixels, double samples)
{
	return 1000 + pixels * 0.5 + pixels * samples * 2 + pixels * 12 * 0.01;
}

static struct quote_record frame(const struct quote_query *q, double times)
{
	static uint64_t stamp;
	struct quote_record r = {.key = q->key,
				 .stamp = ++stamp,
				 .technique = q->technique,
				 .pixels = (uint32_t)q->pixels,
				 .samples = (uint32_t)q->samples,
				 .spread = 0.1f};
	quote_set_part(&r, QUOTE_FIXED, 1000 * times);
	quote_set_part(&r, QUOTE_PIXEL, 0.5 * times);
	quote_set_part(&r, QUOTE_SAMPLE, 2 * times);
	quote_set_part(&r, QUOTE_ENCODE, 0.01 * times);
	quote_set_part(&r, QUOTE_ERROR, 0.8);
	return r;
}

static void teach(struct quote_model *m, const struct quote_query *q, double times)
{
	const struct quote_record r = frame(q, times);
	quote_learn(m, &r, q, true_us(q->pixels, q->samples) * times);
}

static int make_model(void **state)
{
	*state = calloc(1, sizeof(struct quote_model));
	return *state ? 0 : -1;
}

static int free_model(void **state)
{
	free(*state);
	return 0;
}

static double width(const struct quote_prediction *p)
{
	return p->us_high / p->us_low;
}

static void nothing_known_is_a_wide_guess(void **state)
{
	const struct quote_query q = query(1, 1, PT, 4096, 16);
	const struct quote_prediction p = quote_predict(*state, &q);
	assert_true(p.us > 0 && p.error.relmse > 0 && p.records == 0);
	assert_true(width(&p) > 4 && p.error.high / p.error.low > 4);
	assert_int_equal(p.error.kind, candil_ErrorKind_ERROR_KIND_PREDICTED);
}

static void a_frame_tells_of_other_sizes_and_samples(void **state)
{
	struct quote_query q = query(1, 1, PT, 4096, 16);
	teach(*state, &q, 1);
	const struct quote_prediction same = quote_predict(*state, &q);
	NEAR(same.us, true_us(4096, 16), 1.1);
	NEAR(same.error.relmse, 0.05, 1.1);
	q.pixels = 16384;
	q.samples = 64;
	const struct quote_prediction other = quote_predict(*state, &q);
	NEAR(other.us, true_us(16384, 64), 1.2);
	NEAR(other.error.relmse, 0.0125, 1.25);
	assert_true(other.error.high / other.error.low > same.error.high / same.error.low);
}

static void what_is_nearer_says_more(void **state)
{
	struct quote_query q = query(1, 1, PT, 4096, 16);
	teach(*state, &q, 1);
	const struct quote_prediction same = quote_predict(*state, &q);
	q.key.view = 2;
	const struct quote_prediction view = quote_predict(*state, &q);
	q.key.scene = 2;
	const struct quote_prediction scene = quote_predict(*state, &q);
	q.key.where = 2;
	const struct quote_prediction device = quote_predict(*state, &q);
	assert_true(width(&same) < width(&view) && width(&view) < width(&scene) && width(&scene) < width(&device));
	assert_int_equal(view.records, 1);
	assert_int_equal(scene.records, 0);
}

static void a_pilot_says_less_than_a_frame_and_frames_mend_it(void **state)
{
	struct quote_model *m = *state;
	// Pilots of this machine say twice the time that frames take: after a while that is known.
	for (uint64_t scene = 1; scene < 20; scene++) {
		const struct quote_query q = query(scene, 1, PT, 4096, 16);
		struct quote_record pilot = frame(&q, 2);
		pilot.pilot = 1;
		quote_learn(m, &pilot, NULL, 0);
		const struct quote_prediction before = quote_predict(m, &q);
		if (scene == 1)
			assert_true(before.us > 1.4 * true_us(4096, 16));
		if (scene == 19)
			NEAR(before.us, true_us(4096, 16), 1.25);
		teach(m, &q, 1);
	}
}

static void intervals_learn_to_hold_nine_of_ten(void **state)
{
	// Times that no view explains: ±40 %, by a generator of our own.
	struct quote_model *m = *state;
	uint32_t seed = 1;
	unsigned inside = 0;
	for (int i = 0; i < 400; i++) {
		const struct quote_query q = query(1, 1, PT, 4096, 16);
		seed = seed * 1664525u + 1013904223u;
		const double times = exp(0.8 * ((double)(seed >> 8) / 0x1p24 - 0.5));
		const struct quote_prediction p = quote_predict(m, &q);
		const double us = true_us(4096, 16) * times;
		if (i >= 100)
			inside += us >= p.us_low && us <= p.us_high;
		teach(m, &q, times);
	}
	assert_in_range(inside, 240, 297);
}

static void a_scene_of_many_frames_is_one_scene(void **state)
{
	struct quote_model *m = *state;
	// Of five scenes four take four times as long; the fifth has had sixty frames since.
	for (uint64_t i = 0; i < 64; i++) {
		const struct quote_query q = query(i < 4 ? i : 5, 1, PT, 4096, 16);
		const struct quote_record r = frame(&q, i < 4 ? 4 : 1);
		quote_keep(m, &r);
	}
	struct quote_query q = query(9, 1, PT, 4096, 16);
	assert_true(quote_predict(m, &q).us > 2 * true_us(4096, 16));
	// So are views of one scene.
	for (uint64_t i = 0; i < 64; i++) {
		q = query(7, i < 4 ? i : 5, PT, 4096, 16);
		const struct quote_record r = frame(&q, i < 4 ? 4 : 1);
		quote_keep(m, &r);
	}
	q.key.view = 9;
	assert_true(quote_predict(m, &q).us > 2 * true_us(4096, 16));
}

static void intervals_of_scenes_that_are_new_hold(void **state)
{
	// Scenes differ by a factor of up to e² to either side, frames of one by a tenth.
	struct quote_model *m = *state;
	uint32_t seed = 1;
	unsigned inside = 0;
	for (uint64_t scene = 1; scene <= 60; scene++) {
		seed = seed * 1664525u + 1013904223u;
		const double scale = exp(4 * ((double)(seed >> 8) / 0x1p24 - 0.5));
		for (int i = 0; i < 30; i++) {
			const struct quote_query q = query(scene, 1, PT, 4096, 16);
			seed = seed * 1664525u + 1013904223u;
			const double times = scale * exp(0.2 * ((double)(seed >> 8) / 0x1p24 - 0.5));
			const struct quote_prediction p = quote_predict(m, &q);
			const double us = true_us(4096, 16) * times;
			inside += i == 0 && scene > 20 && us >= p.us_low && us <= p.us_high;
			teach(m, &q, times);
		}
	}
	assert_in_range(inside, 32, 40);
}

static void scenes_and_views_are_learned_of_once(void **state)
{
	struct quote_model *m = *state;
	for (uint64_t i = 0; i < 40; i++) {
		// Ten frames of each of four views, the last two of one scene.
		const struct quote_query q = query(i < 30 ? i / 10 : 2, i < 30 ? 1 : 2, PT, 4096, 16);
		teach(m, &q, 1);
	}
	const double *count = m->habits[0].habit[PT][QUOTE_SAMPLE].count;
	assert_int_equal((int)count[QUOTE_OTHERS], 2);
	assert_int_equal((int)count[QUOTE_SCENE], 1);
	assert_int_equal((int)count[QUOTE_FRAMES], 36);
}

static void what_is_near_is_believed_where_all_else_is_far_off(void **state)
{
	struct quote_model *m = *state;
	for (uint64_t scene = 1; scene < 9; scene++) {
		const struct quote_query q = query(scene, 1, PT, 4096, 16);
		teach(m, &q, 1);
	}
	const struct quote_query q = query(9, 1, PT, 4096, 16);
	struct quote_record pilot = frame(&q, 1);
	pilot.pilot = 1;
	pilot.spread = 0.6f;
	quote_set_part(&pilot, QUOTE_ERROR, 150);
	quote_learn(m, &pilot, NULL, 0);
	const struct quote_prediction p = quote_predict(m, &q);
	NEAR(p.error.relmse, 150 / 16.0, 1.3);
	assert_int_equal(p.nearest[1], QUOTE_PILOTS);
}

static void a_small_pilot_says_less_than_a_large_one(void **state)
{
	struct quote_model *m = *state;
	double wide[2];
	for (int i = 0; i < 2; i++) {
		const struct quote_query asked = query(1 + (uint64_t)i, 1, PT, 65536, 16),
					 q = query(1 + (uint64_t)i, 1, PT, i ? 32768 : 1024, 16);
		struct quote_record pilot = frame(&q, 1);
		pilot.pilot = 1;
		quote_learn(m, &pilot, NULL, 0);
		const struct quote_prediction p = quote_predict(m, &asked);
		wide[i] = log(p.error.high / p.error.low);
	}
	assert_true(wide[0] > 1.5 * wide[1]);
}

static void a_device_takes_a_free_place_or_the_oldest(void **state)
{
	struct quote_model *m = *state;
	for (uint64_t where = 1; where <= LIMIT_QUOTE_DEVICES; where++) {
		struct quote_query q = query(1, 1, PT, 4096, 16);
		q.key.where = where;
		teach(m, &q, 1);
	}
	struct quote_query q = query(1, 1, PT, 4096, 16);
	teach(m, &q, 1); // the first is heard of again
	for (uint64_t where = 1; where <= LIMIT_QUOTE_DEVICES; where++)
		assert_int_equal(quote_make_habits(m, where)->where, where);
	struct quote_habits *place = quote_make_habits(m, 77);
	assert_ptr_equal(place, &m->habits[1]);
	m->habits[2] = (struct quote_habits){0};
	assert_ptr_equal(quote_make_habits(m, 78), &m->habits[2]);
}

static void a_setup_and_compiling_are_told_apart(void **state)
{
	struct quote_model *m = *state;
	struct quote_query q = query(1, 1, PT, 4096, 16);
	struct quote_record r = frame(&q, 1);
	quote_set_part(&r, QUOTE_SETUP, 50000);
	quote_set_part(&r, QUOTE_COLD, 3e6);
	quote_learn(m, &r, &q, 0);
	const struct quote_prediction warm = quote_predict(m, &q);
	assert_true(warm.cold_us <= 0);
	q.setup = q.cold = true;
	const struct quote_prediction cold = quote_predict(m, &q);
	NEAR(cold.us - warm.us, 50000, 1.5);
	NEAR(cold.cold_us, 3e6, 1.5);
}

// ---- work that is made once for a scene
// ------------------------------------------------------------------------------------

#define RADIOSITY candil_Technique_TECHNIQUE_RADIOSITY

// A request by radiosity of a scene whose rows are made one way, with so many units of them to be made.
static struct quote_query work_query(uint64_t scene, uint64_t way, double rows)
{
	struct quote_query q = query(scene, 1, RADIOSITY, 4096, 4);
	q.key.light = 1;
	q.key.rows = way;
	q.key.picture = 1;
	q.picture = 1;
	q.work[WORK_ROWS] = rows;
	return q;
}

// A frame that has made its rows, of which a unit takes `us`, and whose error is 0.01.
static struct quote_record work_frame(const struct quote_query *q, double us)
{
	struct quote_record r = frame(q, 1);
	quote_set_part(&r, QUOTE_ROWS, us);
	quote_set_part(&r, QUOTE_ERROR, 0.01);
	return r;
}

static void rows_cost_what_rows_of_their_way_did(void **state)
{
	struct quote_model *m = *state;
	const struct quote_query slow = work_query(1, 7, 1e6), quick = work_query(1, 8, 1e6);
	const struct quote_record a = work_frame(&slow, 4), b = work_frame(&quick, 0.25);
	quote_learn(m, &a, &slow, 0);
	quote_learn(m, &b, &quick, 0);
	struct quote_query none = slow, twice = work_query(1, 8, 2e6);
	none.work[WORK_ROWS] = 0;
	const double picture = quote_predict(m, &none).us;
	NEAR(quote_predict(m, &slow).us - picture, 4e6, 1.25);
	NEAR(quote_predict(m, &quick).us - picture, 0.25e6, 1.25);
	NEAR(quote_predict(m, &twice).us - picture, 0.5e6, 1.25);
	// Of a way that nobody has seen nothing is known but a guess, which is wide.
	const struct quote_query other = work_query(1, 9, 1e6);
	const struct quote_prediction guess = quote_predict(m, &other), known = quote_predict(m, &slow);
	assert_true(width(&guess) > 3 * width(&known));
}

static void work_knows_no_view(void **state)
{
	struct quote_model *m = *state;
	struct quote_query q = work_query(1, 7, 1e6);
	const struct quote_record r = work_frame(&q, 4);
	quote_learn(m, &r, &q, 0);
	const struct quote_prediction same = quote_predict(m, &q);
	q.key.view = 2;
	const struct quote_prediction view = quote_predict(m, &q);
	assert_true(width(&view) < 1.25 * width(&same));
	q.key.light = 2;
	const struct quote_prediction light = quote_predict(m, &q);
	assert_true(width(&light) > 1.25 * width(&view));
}

static void what_may_be_more_work_is_wider(void **state)
{
	struct quote_model *m = *state;
	struct quote_query q = work_query(1, 7, 1e6);
	const struct quote_record r = work_frame(&q, 4);
	quote_learn(m, &r, &q, 0);
	const struct quote_prediction sure = quote_predict(m, &q);
	q.doubt[WORK_ROWS] = 1;
	const struct quote_prediction unsure = quote_predict(m, &q);
	assert_true(unsure.us >= sure.us && unsure.us <= sure.us);
	NEAR(log(unsure.us_high / unsure.us), hypot(log(sure.us_high / sure.us), 1.645), 1.1);
}

static void an_error_is_that_of_its_settings_and_light_or_unknown(void **state)
{
	struct quote_model *m = *state;
	struct quote_query q = work_query(1, 7, 0);
	assert_true(quote_predict(m, &q).error.relmse < 0);
	const struct quote_record r = work_frame(&q, 4);
	quote_keep(m, &r);
	NEAR(quote_predict(m, &q).error.relmse, 0.01, 1.2);
	assert_int_equal(quote_count_light(m, &q.key, QUOTE_ERROR), 1);
	// From elsewhere it is much the same, but not with other lights, with other patches or in another scene.
	q.key.view = 2;
	NEAR(quote_predict(m, &q).error.relmse, 0.01, 2);
	struct quote_query lights = q, patches = q, scene = q;
	lights.key.light = 2;
	patches.key.look = 77;
	scene.key.scene = 2;
	const struct quote_query *const others[] = {&lights, &patches, &scene};
	for (int i = 0; i < 3; i++) {
		const struct estimate e = quote_predict(m, others[i]).error;
		assert_true(e.relmse < 0 && e.kind == candil_ErrorKind_ERROR_KIND_UNKNOWN);
		assert_int_equal(quote_count_light(m, &others[i]->key, QUOTE_ERROR), 0);
	}
	// Techniques without such work are guessed, as ever.
	const struct quote_query vct = query(1, 1, candil_Technique_TECHNIQUE_VCT, 64, 1);
	assert_true(quote_predict(m, &vct).error.relmse > 0);
}

static void the_oldest_records_go(void **state)
{
	struct quote_model *m = *state;
	for (uint32_t i = 0; i < LIMIT_QUOTE_RECORDS + 10; i++) {
		const struct quote_query q = query(i < 10 ? 1 : 2, 1, PT, 64, 1);
		const struct quote_record r = frame(&q, 1);
		quote_keep(m, &r);
	}
	const struct quote_key first = {.where = 1, .scene = 1}, second = {.where = 1, .scene = 2};
	assert_int_equal(m->count, LIMIT_QUOTE_RECORDS);
	assert_int_equal(quote_count_scene(m, &first), 0);
	assert_int_equal(quote_count_scene(m, &second), LIMIT_QUOTE_RECORDS);
}

// ---- the file --------------------------------------------------------------------------------------------------------

static void a_model_comes_back_from_its_file(void **state)
{
	struct quote_model *m = *state, *again = calloc(1, sizeof *again);
	struct quote_query q = query(1, 1, PT, 4096, 16);
	struct error err;
	size_t bytes;
	assert_non_null(again);
	for (int i = 0; i < 5; i++)
		teach(m, &q, 1 + 0.1 * i);
	uint8_t *data = quote_store_encode(m, &bytes);
	assert_non_null(data);
	assert_int_equal(quote_store_decode(data, bytes, again, &err), STATUS_OK);
	const struct quote_prediction a = quote_predict(m, &q), b = quote_predict(again, &q);
	NEAR(a.us, b.us, 1 + 1e-12);
	NEAR(a.us_high, b.us_high, 1 + 1e-12);
	NEAR(a.error.high, b.error.high, 1 + 1e-12);
	assert_int_equal(a.records, b.records);
	free(data);
	free(again);
}

static void a_damaged_file_is_refused_and_leaves_nothing(void **state)
{
	struct quote_model *m = *state, *empty = calloc(1, sizeof *empty), *again = calloc(1, sizeof *again);
	const struct quote_query q = query(1, 1, PT, 4096, 16);
	struct error err;
	size_t bytes;
	assert_true(empty && again);
	teach(m, &q, 1);
	uint8_t *data = quote_store_encode(m, &bytes);
	assert_non_null(data);
	for (size_t i = 0; i < bytes; i += i < 64 ? 1 : 97) {
		data[i] ^= 0x10;
		assert_int_equal(quote_store_decode(data, bytes, again, &err), STATUS_BAD_MESSAGE);
		assert_memory_equal(again, empty, sizeof *again);
		data[i] ^= 0x10;
		assert_int_equal(quote_store_decode(data, i, again, &err), STATUS_BAD_MESSAGE);
	}
	free(data);
	free(again);
	free(empty);
}

// Write a model as anyone could, with a checksum that is right.
static void assert_refused(const struct quote_model *m)
{
	struct quote_model *again = calloc(1, sizeof *again);
	struct error err;
	size_t bytes;
	uint8_t *data = quote_store_encode(m, &bytes);
	assert_true(data && again);
	assert_int_equal(quote_store_decode(data, bytes, again, &err), STATUS_BAD_MESSAGE);
	assert_int_equal(again->count, 0);
	free(data);
	free(again);
}

static void numbers_that_cannot_be_are_refused(void **state)
{
	struct quote_model *m = *state;
	const struct quote_query q = query(1, 1, PT, 4096, 16);
	teach(m, &q, 1);
	const struct quote_record good = m->records[0];
#define BAD(change) \
	m->records[0] = good; \
	m->records[0].change; \
	assert_refused(m);
	BAD(technique = TECHNIQUE_COUNT)
	BAD(technique = 1000)
	BAD(pixels = 0)
	BAD(samples = 0)
	BAD(pilot = 2)
	BAD(known = ~0u)
	BAD(part[0] = NAN)
	BAD(part[2] = 1e30f)
	BAD(spread = -1)
	BAD(spread = INFINITY)
	m->records[0] = good;
	m->habits[0].habit[1][0].count[0] = NAN;
	assert_refused(m);
	m->habits[0].habit[1][0].count[0] = 1;
	m->habits[0].habit[1][0].ps = 100;
	assert_refused(m);
	m->habits[0].habit[1][0].ps = 0;
	m->habits[0].stretch[1][0][2] = 1e9;
	assert_refused(m);
	m->habits[0].stretch[1][0][2] = 1;
	// Sums of nothing, of what nothing adds to them, and with squares that are less than the mean's.
	struct quote_habit *h = &m->habits[0].habit[PT][QUOTE_SAMPLE];
	for (int i = 0; i < 3; i++) {
		h->count[QUOTE_PILOTS] = i;
		h->sum[QUOTE_PILOTS] = i == 2 ? 0.5 : 1e6;
		h->squares[QUOTE_PILOTS] = i == 2 ? 0.01 : 1;
		assert_refused(m);
	}
	h->count[QUOTE_PILOTS] = h->sum[QUOTE_PILOTS] = h->squares[QUOTE_PILOTS] = 0;
	// What is let in gives numbers.
	for (int part = 0; part < QUOTE_PARTS; part++)
		m->habits[0].habit[PT][part].p = m->habits[0].habit[PT][part].s = -1e6;
	m->habits[0].habit[PT][QUOTE_ERROR].p = 1e6;
	m->records[0].spread = 100;
	assert_true(quote_habits_hold(&m->habits[0]) && quote_record_holds(&m->records[0]));
	const struct quote_query far = query(1, 1, PT, 268435456, 65536);
	const struct quote_prediction p = quote_predict(m, &far);
	assert_true(isfinite(p.us_high) && p.us_low > 0 && isfinite(p.error.high) && p.error.low > 0);
}

// ---- the choice ------------------------------------------------------------------------------------------------------

// pt takes 10 ms a sample and is wrong by 1 / samples; all others take 5 ms a sample and are wrong by 0.1 whatever the
// samples.
static void predict(void *user, struct quote_way *way)
{
	const bool noisy = technique_traits(way->technique) & TECHNIQUE_NOISE;
	(void)user;
	way->said.us = way->samples * (noisy ? 10000.0 : 5000.0) + (double)(int)way->technique;
	way->said.us_high = 1.5 * way->said.us;
	way->said.error.relmse = noisy ? 1.0 / way->samples : 0.1 + 0.001 * (int)way->technique;
	way->said.error.high = 1.2 * way->said.error.relmse;
	way->said.measured_high = 1.1 * way->said.error.relmse;
	way->said.cold_us = noisy ? 0 : 1e6;
}

static candil_QuoteReply choose(const candil_Render *render, bool count_cold)
{
	const struct quote_ask ask = {.render = render, .count_cold = count_cold, .predict = predict};
	candil_QuoteReply reply = {0};
	quote_choose(&ask, &reply);
	assert_true(reply.has_choice && reply.why[0]);
	return reply;
}

static void the_least_error_within_a_time(void **state)
{
	candil_Render r = {.width = 64, .height = 64, .samples = QUOTE_OPEN_SAMPLES, .deadline_ms = 1000};
	(void)state;
	candil_QuoteReply a = choose(&r, false);
	assert_true(a.met && a.choice.technique == PT);
	assert_int_equal(a.choice.samples, 99);
	r.deadline_ms = 50;
	a = choose(&r, false);
	assert_true(a.met && !(technique_traits(a.choice.technique) & TECHNIQUE_NOISE));
	assert_true(a.has_better && a.better.technique == PT && a.better.samples >= 16);
	// Where compiling counts, what is compiled is taken.
	a = choose(&r, true);
	assert_true(a.met && a.choice.technique == PT);
	assert_int_equal(a.choice.samples, 4);
}

static void the_least_time_within_an_error(void **state)
{
	candil_Render r = {.width = 64, .height = 64, .samples = QUOTE_OPEN_SAMPLES, .target_error = 0.01};
	(void)state;
	candil_QuoteReply a = choose(&r, false);
	assert_true(a.met && a.choice.technique == PT);
	// It ends where the upper end of 1.1 / samples is first compared and low enough.
	assert_int_equal(a.choice.samples, 128);
	r.target_error = 1.1 / 96;
	assert_int_equal(choose(&r, false).choice.samples, 96);
	r.technique = PT;
	r.target_error = 0.9;
	assert_int_equal(choose(&r, false).choice.samples, 8);
	r.technique = candil_Technique_TECHNIQUE_AUTO;
	r.target_error = 0.2;
	a = choose(&r, false);
	assert_true(a.met && a.choice.time_ms < 6);
	assert_false(a.has_cheaper);
}

static void what_cannot_be_met_says_the_nearest(void **state)
{
	candil_Render r = {.width = 64, .height = 64, .samples = QUOTE_OPEN_SAMPLES, .deadline_ms = 1};
	(void)state;
	candil_QuoteReply a = choose(&r, false);
	assert_true(!a.met && a.choice.samples == 1 && strstr(a.why, "cannot be met: nearest is"));
	r = (candil_Render){.technique = DIRECT, .width = 64, .height = 64, .samples = 1, .target_error = 0.001};
	a = choose(&r, false);
	assert_true(!a.met && a.choice.technique == DIRECT && strstr(a.why, "stays"));
	r = (candil_Render){.width = 64, .height = 64, .samples = QUOTE_OPEN_SAMPLES, .target_error = 1e-9};
	a = choose(&r, false);
	assert_true(!a.met && a.choice.technique == PT && a.choice.samples == QUOTE_OPEN_SAMPLES);
}

static void of_what_misses_the_error_the_nearest_is_in_time(void **state)
{
	candil_Render r = {
	    .width = 64, .height = 64, .samples = QUOTE_OPEN_SAMPLES, .target_error = 1e-6, .deadline_ms = 1000};
	(void)state;
	candil_QuoteReply a = choose(&r, false);
	assert_true(!a.met && a.choice.technique == PT && strstr(a.why, "in that time the error is about"));
	assert_int_equal(a.choice.samples, 99);
	// Before the first checkpoint, too.
	r.technique = PT;
	r.deadline_ms = 45;
	a = choose(&r, false);
	assert_true(!a.met && a.choice.samples == 4);
	r.target_error = 0.5;
	a = choose(&r, false);
	assert_true(a.met);
	// It goes on to the deadline or its first look at the error.
	r.target_error = 0.9;
	a = choose(&r, false);
	assert_true(a.met && a.choice.samples == 4);
	r.deadline_ms = 100;
	a = choose(&r, false);
	assert_true(a.met && a.choice.samples == 8);
	// Of what is late, the quickest.
	r = (candil_Render){
	    .width = 64, .height = 64, .samples = QUOTE_OPEN_SAMPLES, .target_error = 1e-6, .deadline_ms = 1};
	a = choose(&r, false);
	assert_true(!a.met && a.choice.technique != PT && a.choice.samples == 1);
}

static void what_is_not_cut_short_is_surely_in_time(void **state)
{
	// One sample by what has no noise takes 5 ms, but may take 7.5; the first of pt 10 or 15.
	candil_Render r = {.width = 64, .height = 64, .samples = QUOTE_OPEN_SAMPLES, .technique = DIRECT, .deadline_ms = 6};
	(void)state;
	candil_QuoteReply a = choose(&r, false);
	assert_true(!a.met && strstr(a.why, "may take 7.51 ms"));
	r.deadline_ms = 8;
	assert_true(choose(&r, false).met);
	r.technique = PT;
	r.deadline_ms = 14;
	a = choose(&r, false);
	assert_true(!a.met && strstr(a.why, "1 sample of 64 x 64 pixels may take 15 ms"));
	r.deadline_ms = 21;
	a = choose(&r, false);
	assert_true(a.met && a.choice.samples == 2);
}

// Another job goes first for 30 ms.
static double others(void *user, double us)
{
	(void)user;
	return fmin(us, 30000);
}

static void what_others_add_counts(void **state)
{
	candil_Render r = {.width = 64, .height = 64, .samples = QUOTE_OPEN_SAMPLES, .deadline_ms = 1000};
	const struct quote_ask ask = {.render = &r, .queue_us = others, .predict = predict};
	candil_QuoteReply a = {0};
	(void)state;
	quote_choose(&ask, &a);
	assert_int_equal(a.choice.samples, 96);
}

static void what_could_not_render_the_scene_is_not_chosen(void **state)
{
	candil_Render r = {.width = 64, .height = 64, .samples = QUOTE_OPEN_SAMPLES, .deadline_ms = 50};
	struct quote_ask ask = {.render = &r, .predict = predict};
	candil_QuoteReply a = {0};
	(void)state;
	quote_choose(&ask, &a);
	assert_true(a.choice.technique != PT);
	ask.refused = ~(1u << PT);
	quote_choose(&ask, &a);
	assert_int_equal(a.choice.technique, PT);
	// What is named is named, and some technique is always chosen.
	ask.refused = ~0u;
	quote_choose(&ask, &a);
	assert_true(a.has_choice && a.choice.technique != PT);
	r.technique = DIRECT;
	quote_choose(&ask, &a);
	assert_int_equal(a.choice.technique, DIRECT);
}

static void this_very_request(void **state)
{
	const candil_Render r = {.width = 64, .height = 64, .samples = 33};
	(void)state;
	const candil_QuoteReply a = choose(&r, false);
	assert_true(a.met && a.choice.technique == PT && a.choice.samples == 33);
	NEAR(a.choice.time_ms, 330, 1.001);
}

// A pilot that has measured relMSE × samples, with this deviation of its logarithm.
static void look(struct quote_model *m, const struct quote_query *q, double error, float spread)
{
	struct quote_record pilot = frame(q, 1);
	pilot.pilot = 1;
	pilot.pixels /= 4;
	pilot.spread = spread;
	quote_set_part(&pilot, QUOTE_ERROR, error);
	quote_learn(m, &pilot, NULL, 0);
}

static void scenes_that_are_easy_do_not_vouch_for_one_that_is_not(void **state)
{
	struct quote_model *m = *state;
	// Frames of easy scenes have half the error that their pilots said, and lie inside.
	for (uint64_t scene = 1; scene < 30; scene++) {
		const struct quote_query q = query(scene, 1, PT, 4096, 16);
		struct quote_record r = frame(&q, 1);
		const double error = 0.8 * exp2((double)(scene % 7) - 3);
		quote_set_part(&r, QUOTE_ERROR, error);
		look(m, &q, 2 * error, 0.1f);
		quote_learn(m, &r, &q, true_us(4096, 16));
	}
	struct quote_query q = query(50, 1, PT, 4096, 16);
	look(m, &q, 1.6, 0.1f);
	const struct quote_prediction easy = quote_predict(m, &q);
	NEAR(easy.error.relmse, 0.05, 1.25);
	q.key.scene = 51;
	look(m, &q, 1.6, 0.5f);
	const struct quote_prediction hard = quote_predict(m, &q);
	// Of a pilot that is as unsure as that, neither its mean nor its width is known better.
	assert_true(hard.error.relmse > 1.1 * easy.error.relmse);
	assert_true(log(hard.error.high / hard.error.relmse) > 1.645 * 0.5 * 0.9);
}

// As predict, but that nobody knows how wrong radiosity is.
static void predict_without(void *user, struct quote_way *way)
{
	predict(user, way);
	if (way->technique != RADIOSITY)
		return;
	way->said.error = ESTIMATE_UNKNOWN;
	way->said.us = way->said.us_high = 1;
}

static void an_error_that_is_not_known_is_not_chosen(void **state)
{
	candil_Render r = {.width = 64, .height = 64, .samples = QUOTE_OPEN_SAMPLES, .deadline_ms = 50};
	const struct quote_ask ask = {.render = &r, .predict = predict_without};
	candil_QuoteReply a = {0};
	(void)state;
	quote_choose(&ask, &a);
	assert_true(a.met && a.choice.technique != RADIOSITY && a.choice.relmse > 0);
	assert_true(!a.has_cheaper || a.cheaper.relmse > 0);
	r.deadline_ms = 0;
	r.target_error = 0.2;
	quote_choose(&ask, &a);
	assert_true(a.met && a.choice.technique != RADIOSITY);
	// What is named is, and says so.
	r.technique = RADIOSITY;
	r.samples = 1;
	quote_choose(&ask, &a);
	assert_true(!a.met && a.choice.technique == RADIOSITY && a.choice.relmse < 0 &&
		    strstr(a.why, "its error is not known"));
	r.target_error = 0;
	quote_choose(&ask, &a);
	assert_true(a.met && a.choice.relmse < 0 && !a.has_better && !a.has_cheaper);
}

static void options_and_lenses_leave_what_takes_them(void **state)
{
	candil_Render r = {.width = 1, .height = 1, .options_count = 1};
	(void)state;
	strcpy(r.options[0].name, "pt.depth");
	assert_true(quote_can(&r, PT));
	assert_false(quote_can(&r, DIRECT));
	strcpy(r.options[0].name, "direct.samples");
	assert_true(quote_can(&r, DIRECT) && quote_can(&r, candil_Technique_TECHNIQUE_VCT));
	assert_false(quote_can(&r, PT));
	r = (candil_Render){.width = 1, .height = 1, .lens = {.radius = 1}};
	assert_true(quote_can(&r, PT));
	assert_false(quote_can(&r, DIRECT));
	r = (candil_Render){.width = 1, .height = 1, .technique = DIRECT};
	assert_true(quote_can(&r, DIRECT));
	assert_false(quote_can(&r, PT));
	assert_false(quote_can(&r, (candil_Technique)TECHNIQUE_COUNT));
}

static void keys_know_what_shows(void **state)
{
	const struct subject_hashes scene = {.part[PART_SCENE] = "s"};
	const struct subject_hashes lit = {.part = {[PART_SCENE] = "s", [PART_ENVIRONMENT] = "e"}};
	candil_Render a = {.width = 64, .height = 64, .samples = 4}, b = a;
	(void)state;
	b.width = 128;
	b.samples = 9;
	b.seed = 3;
	b.format = candil_Format_FORMAT_PNG;
	b.deadline_ms = 5;
	struct quote_key x = quote_key_of(&a, PT, &scene, "d"), y = quote_key_of(&b, PT, &scene, "d");
	assert_memory_equal(&x, &y, sizeof x);
	b.has_camera = true;
	b.camera.vfov_degrees = 30;
	y = quote_key_of(&b, PT, &scene, "d");
	assert_true(x.view != y.view && x.look == y.look && x.scene == y.scene && x.light == y.light);
	assert_true(quote_warmth_of(&x, 1) == quote_warmth_of(&y, 1));
	assert_true(quote_warmth_of(&x, 1) != quote_warmth_of(&x, 2));
	b.has_edits = true;
	b.edits.replace_lights = true;
	y = quote_key_of(&b, PT, &scene, "d");
	assert_true(x.light != y.light && quote_warmth_of(&x, 1) != quote_warmth_of(&y, 1));
	// The order of options is no difference, and what they say is one.
	a.options_count = b.options_count = 2;
	strcpy(a.options[0].name, "pt.depth");
	strcpy(a.options[1].name, "pt.clamp");
	strcpy(b.options[1].name, "pt.depth");
	strcpy(b.options[0].name, "pt.clamp");
	x = quote_key_of(&a, PT, &scene, "d");
	y = quote_key_of(&b, PT, &scene, "d");
	assert_true(x.look == y.look);
	strcpy(b.options[1].value, "3");
	y = quote_key_of(&b, PT, &lit, "other");
	assert_true(x.look != y.look && x.scene != y.scene && x.where != y.where);
	// Those of another technique are none of a reference's.
	const candil_Technique vct = candil_Technique_TECHNIQUE_VCT;
	candil_Render plain = a;
	plain.options_count = 0;
	x = quote_key_of(&a, vct, &scene, "d");
	y = quote_key_of(&plain, vct, &scene, "d");
	assert_true(x.look == y.look);
	// But some techniques take those of others.
	strcpy(a.options[0].name, "direct.samples");
	x = quote_key_of(&a, vct, &scene, "d");
	assert_true(x.look != y.look);
}

int main(void)
{
#define WITH_MODEL(name) cmocka_unit_test_setup_teardown(name, make_model, free_model)
	const struct CMUnitTest tests[] = {
	    WITH_MODEL(nothing_known_is_a_wide_guess),
	    WITH_MODEL(a_frame_tells_of_other_sizes_and_samples),
	    WITH_MODEL(what_is_nearer_says_more),
	    WITH_MODEL(a_pilot_says_less_than_a_frame_and_frames_mend_it),
	    WITH_MODEL(intervals_learn_to_hold_nine_of_ten),
	    WITH_MODEL(a_scene_of_many_frames_is_one_scene),
	    WITH_MODEL(intervals_of_scenes_that_are_new_hold),
	    WITH_MODEL(scenes_and_views_are_learned_of_once),
	    WITH_MODEL(what_is_near_is_believed_where_all_else_is_far_off),
	    WITH_MODEL(a_small_pilot_says_less_than_a_large_one),
	    WITH_MODEL(a_device_takes_a_free_place_or_the_oldest),
	    WITH_MODEL(a_setup_and_compiling_are_told_apart),
	    WITH_MODEL(rows_cost_what_rows_of_their_way_did),
	    WITH_MODEL(work_knows_no_view),
	    WITH_MODEL(what_may_be_more_work_is_wider),
	    WITH_MODEL(an_error_is_that_of_its_settings_and_light_or_unknown),
	    cmocka_unit_test(an_error_that_is_not_known_is_not_chosen),
	    WITH_MODEL(the_oldest_records_go),
	    WITH_MODEL(a_model_comes_back_from_its_file),
	    WITH_MODEL(a_damaged_file_is_refused_and_leaves_nothing),
	    WITH_MODEL(numbers_that_cannot_be_are_refused),
	    cmocka_unit_test(the_least_error_within_a_time),
	    cmocka_unit_test(the_least_time_within_an_error),
	    cmocka_unit_test(what_cannot_be_met_says_the_nearest),
	    cmocka_unit_test(of_what_misses_the_error_the_nearest_is_in_time),
	    cmocka_unit_test(what_is_not_cut_short_is_surely_in_time),
	    cmocka_unit_test(what_others_add_counts),
	    cmocka_unit_test(what_could_not_render_the_scene_is_not_chosen),
	    cmocka_unit_test(this_very_request),
	    cmocka_unit_test(options_and_lenses_leave_what_takes_them),
	    WITH_MODEL(scenes_that_are_easy_do_not_vouch_for_one_that_is_not),
	    cmocka_unit_test(keys_know_what_shows),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
