// A pilot's two halves, and its word on the bias of a picture beside them.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "protocol/limits.h"
#include "server/worker/pilot/pilot.h"
#include "server/worker/technique/technique.h"

#define SIDE 64u
#define FLOATS (3u * SIDE * SIDE)

static float half[2][FLOATS], picture[FLOATS];

static double uniform(void)
{
	static uint32_t seed = 7;
	seed = seed * 1664525u + 1013904223u;
	return ((double)(seed >> 8) + 0.5) / 0x1p24;
}

// Light that is there with a chance of `share` a sample, 4 samples a half: its mean is `mean`.
static float noisy(double mean, double share)
{
	double sum = 0;
	for (int i = 0; i < 4; i++)
		sum += uniform() < share ? mean / share : 0;
	return (float)(sum / 4);
}

static struct estimate bias_of(double mean, double share, double off)
{
	const struct pilot_reference r = {SIDE, SIDE, {half[0], half[1]}};
	for (uint32_t i = 0; i < FLOATS; i++) {
		picture[i] = (float)(mean * (1 + off));
		half[0][i] = noisy(mean, share);
		half[1][i] = noisy(mean, share);
	}
	return pilot_bias(picture, &r);
}

static void noise_is_no_bias(void **state)
{
	(void)state;
	// The halves' own relMSE is some 0.5: what is left of it is within a tenth.
	const struct estimate e = bias_of(0.5, 0.3, 0);
	assert_true(e.relmse < 0.05);
}

static void bias_shows_behind_noise(void **state)
{
	(void)state;
	for (int i = 0; i < 3; i++) {
		const double off = (const double[]){-0.8, 0.5, 1.5}[i], mean = 0.5;
		const double truth = off * mean * off * mean / (mean * mean + 0.01);
		const struct estimate e = bias_of(mean, 0.5, off);
		assert_true(e.relmse < 1.4 * truth && truth < 1.4 * e.relmse);
		assert_true(e.low > 0 && e.low <= e.relmse && e.relmse <= e.high);
	}
}

static void one_firefly_is_not_the_picture(void **state)
{
	const struct pilot_reference r = {SIDE, SIDE, {half[0], half[1]}};
	(void)state;
	const double before = bias_of(0.5, 0.8, 0.5).relmse;
	half[0][3 * (SIDE * 20 + 20)] = 1e4f;
	const double after = pilot_bias(picture, &r).relmse;
	assert_true(after < 1.2 * before && before < 1.2 * after);
}

static void no_number_is_no_answer(void **state)
{
	const struct pilot_reference r = {SIDE, SIDE, {half[0], half[1]}};
	(void)state;
	bias_of(0.5, 0.8, 0.5);
	picture[5] = INFINITY;
	assert_int_equal(pilot_bias(picture, &r).kind, candil_ErrorKind_ERROR_KIND_UNKNOWN);
}

static void the_halves_have_noise_of_their_own(void **state)
{
	const candil_Render asked = {
	    .width = 200, .height = 100, .samples = 9, .seed = 5, .deadline_ms = 3, .target_error = 0.5};
	struct pilot_picture wanted = {candil_Technique_TECHNIQUE_PT, 800, 8, 0};
	candil_Render a, b, again;
	(void)state;
	pilot_request(&asked, &wanted, &a);
	pilot_request(&asked, &wanted, &again);
	wanted.half = 1;
	pilot_request(&asked, &wanted, &b);
	// Not two parts of one sequence.
	assert_true(a.seed != b.seed && a.seed != asked.seed && b.seed != asked.seed);
	assert_true(a.first_sample == 0 && b.first_sample == 0 && a.samples == 8 && b.samples == 8);
	assert_true(a.width == 40 && a.height == 20 && a.deadline_ms == 0 && a.target_error <= 0);
	assert_memory_equal(&a, &again, sizeof a);
}

static void a_reference_is_drawn_by_its_own_options(void **state)
{
	const struct pilot_picture own = {candil_Technique_TECHNIQUE_VCT, 800, 4, 0},
				   reference = {candil_Technique_TECHNIQUE_PT, 800, 8, 0};
	candil_Render asked = {.width = 40, .height = 20, .options_count = 2}, r;
	(void)state;
	strcpy(asked.options[0].name, "pt.depth");
	strcpy(asked.options[1].name, "vct.resolution");
	pilot_request(&asked, &own, &r);
	assert_int_equal(r.options_count, 1);
	assert_string_equal(r.options[0].name, "vct.resolution");
	pilot_request(&asked, &reference, &r);
	assert_int_equal(r.options_count, 1);
	assert_string_equal(r.options[0].name, "pt.depth");
}

static void two_halves_say_what_both_know(void **state)
{
	const candil_ErrorKind kind = candil_ErrorKind_ERROR_KIND_MEASURED;
	const struct estimate a = {1, 0.5, 2, kind}, b = {3, 1.5, 4, kind}, open = {3, 1.5, -1, kind},
			      none = ESTIMATE_UNKNOWN;
	(void)state;
	struct estimate e = pilot_mean(&a, &b);
	assert_true(fabs(e.relmse - 2) < 1e-9 && fabs(e.low - 1) < 1e-9 && fabs(e.high - 3) < 1e-9);
	// Without an upper end of one there is none of both, and the error is not the lower of the two.
	for (int i = 0; i < 2; i++) {
		e = i ? pilot_mean(&a, &open) : pilot_mean(&open, &a);
		assert_true(fabs(e.relmse - 2) < 1e-9 && e.high < 0);
		e = i ? pilot_mean(&a, &none) : pilot_mean(&none, &a);
		assert_true(fabs(e.relmse - 1) < 1e-9 && fabs(e.high - 2) < 1e-9);
	}
	assert_int_equal(pilot_mean(&none, &none).kind, candil_ErrorKind_ERROR_KIND_UNKNOWN);
}

static void a_sample_has_a_time_that_no_pixel_decides(void **state)
{
	const double pixels[] = {1000, 4000};
	(void)state;
	// 12 ms of triangles a sample, and 2 µs a pixel.
	assert_true(fabs(pilot_sample_us(pixels, (const double[]){14000, 20000}, 4000) - 20000) < 1e-6);
	assert_true(fabs(pilot_sample_us(pixels, (const double[]){14000, 20000}, 16000) - 44000) < 1e-6);
	// Of luck neither part is negative.
	assert_true(fabs(pilot_sample_us(pixels, (const double[]){30000, 20000}, 16000) - 20000) < 1e-6);
	assert_true(fabs(pilot_sample_us(pixels, (const double[]){100, 20000}, 16000) - 80000) < 1e-6);
	assert_true(fabs(pilot_sample_us((const double[]){4000, 4000}, (const double[]){9, 20000}, 2000) - 10000) < 1e-6);
}

static void what_more_samples_mend_lies_at_edges(void **state)
{
	const candil_ErrorKind kind = candil_ErrorKind_ERROR_KIND_PREDICTED;
	struct pilot_bias bias[2] = {{1024, 4, 0, {0.02, 0.005, 0.03, kind}}, {1024, 1, 0, {0.05, 0.005, 0.06, kind}}};
	(void)state;
	// 0.01 is bias; 0.04 of one sample lies at edges, and so 0.01 of four.
	pilot_edges(bias);
	assert_true(fabs(bias[0].edges - 0.5) < 1e-9 && fabs(bias[1].edges - 0.8) < 1e-9);
	// What more samples do not mend does not.
	bias[0].error = bias[1].error;
	pilot_edges(bias);
	assert_true(bias[0].edges < 1e-9 && bias[1].edges < 1e-9);
	// One pixel of a lamp's rim does not make a picture ten times worse than four samples have it.
	bias[0].error = (struct estimate){0.01, 0.005, 0.015, kind};
	bias[1].error = (struct estimate){0.1, 0.05, 0.2, kind};
	pilot_edges(bias);
	assert_true(fabs(bias[1].error.relmse - 0.04) < 1e-9 && fabs(bias[1].error.high - 0.08) < 1e-9);
	assert_true(fabs(bias[1].edges - 1) < 1e-9);
	bias[0] = (struct pilot_bias){1024, 4, 0, ESTIMATE_UNKNOWN};
	bias[1].edges = 0;
	pilot_edges(bias);
	assert_true(bias[0].edges < 1e-9 && bias[1].edges < 1e-9);
}

static void the_longest_pilot_is_not_given_up(void **state)
{
	(void)state;
	assert_true(pilot_patience_us(LIMIT_PILOT_MS * 1000u) > LIMIT_PILOT_MS * 1000ull);
	assert_true(pilot_patience_us(1000) < 11000000);
}

// Which options a technique takes is known to the front by their beginnings alone.
static void options_are_of_the_techniques_that_names_h_says(void **state)
{
	(void)state;
	for (uint32_t i = 0; i < technique_count(); i++)
		for (const struct option_table *of = technique_at(i)->options; of->rules; of++)
			for (size_t r = 0; r < of->count; r++)
				for (uint32_t k = 0; k < technique_count(); k++)
					assert_int_equal(option_known(technique_at(k)->options, of->rules[r].name),
							 technique_takes(technique_at(k)->number, of->rules[r].name));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(options_are_of_the_techniques_that_names_h_says),
	    cmocka_unit_test(noise_is_no_bias),
	    cmocka_unit_test(bias_shows_behind_noise),
	    cmocka_unit_test(one_firefly_is_not_the_picture),
	    cmocka_unit_test(the_halves_have_noise_of_their_own),
	    cmocka_unit_test(a_reference_is_drawn_by_its_own_options),
	    cmocka_unit_test(two_halves_say_what_both_know),
	    cmocka_unit_test(a_sample_has_a_time_that_no_pixel_decides),
	    cmocka_unit_test(what_more_samples_mend_lies_at_edges),
	    cmocka_unit_test(the_longest_pilot_is_not_given_up),
	    cmocka_unit_test(no_number_is_no_answer),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
