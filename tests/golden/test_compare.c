// candil-compare's figures against numbers worked out by hand.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/compare/flip.h"
#include "server/compare/heat.h"
#include "server/compare/metrics.h"
#include "server/worker/image/view.h"

#define CLOSE(got, expected) assert_true(fabs((double)(got) - (double)(expected)) <= 1e-7 * (1 + fabs((double)(expected))))

static struct picture make(uint32_t width, uint32_t height, const float *rgb)
{
	size_t values = (size_t)width * height * 3;
	struct picture p = {.width = width, .height = height, .rgb = malloc(values * sizeof *p.rgb)};
	assert_non_null(p.rgb);
	if (rgb)
		memcpy(p.rgb, rgb, values * sizeof *p.rgb);
	return p;
}

static void figures_are_those_worked_out_by_hand(void **state)
{
	(void)state;
	const float x[6] = {1, 2, 0, 0.5f, 0, 0.25f}, r[6] = {0, 2, 0.5f, 0.5f, 1, 0.25f};
	struct picture a = make(2, 1, x), b = make(2, 1, r);
	struct metrics m;
	float error[2];
	struct error err;
	assert_int_equal(metrics_compare(&a, &b, (double)INFINITY, &m, error, &err), STATUS_OK);
	// Differences: 1 0 -0.5 | 0 -1 0.
	CLOSE(m.rmse, sqrt((1 + 0.25 + 1) / 6));
	double first = 1 / 0.01 + 0.25 / 0.26, second = 1 / 1.01;
	CLOSE(m.relmse, (first + second) / 6);
	CLOSE(error[0], sqrt(first / 3));
	CLOSE(error[1], sqrt(second / 3));
	CLOSE(m.mean_difference, -0.5 / 6);
	CLOSE(m.max_abs, 1);
	CLOSE(m.mean_a, 3.75 / 6);
	CLOSE(m.mean_b, 4.25 / 6);
	CLOSE(m.mean_a_rgb[0], 0.75);
	CLOSE(m.mean_b_rgb[1], 1.5);
	assert_int_equal(m.pixels, 2);
	assert_int_equal(m.masked + m.non_finite_a + m.non_finite_b, 0);
	picture_finish(&a);
	picture_finish(&b);
}

static void masked_and_broken_pixels_are_left_out(void **state)
{
	(void)state;
	// Equal but for: a mask by one channel, a NaN in A, an infinity in B, and one honest difference.
	const float x[15] = {9, 9, 9, NAN, 0, 0, 1, 1, 1, 1, 1, 1.5f, 2, 2, 2};
	const float r[15] = {0, 3, 0, 0, 0, 0, 1, -INFINITY, 1, 1, 1, 1, 2, 2, 2};
	struct picture a = make(5, 1, x), b = make(5, 1, r);
	struct metrics m;
	float error[5];
	struct error err;
	assert_int_equal(metrics_compare(&a, &b, 2, &m, error, &err), STATUS_OK);
	assert_int_equal(m.pixels, 2); // a value equal to the mask's stays
	assert_int_equal(m.masked, 1);
	assert_int_equal(m.non_finite_a, 1);
	assert_int_equal(m.non_finite_b, 1);
	CLOSE(m.max_abs, 0.5);
	CLOSE(m.rmse, sqrt(0.25 / 6));
	assert_true(error[0] == -1 && error[1] == -2 && error[2] == -2 && error[4] == 0);
	metrics_blank(&a, &b, error);
	for (int i = 0; i < 9; i++)
		assert_true(a.rgb[i] == 0 && b.rgb[i] == 0);
	assert_true(a.rgb[9] == 1);
	assert_int_equal(metrics_compare(&a, &b, -1, &m, error, &err), STATUS_BAD_ARGUMENT);
	picture_finish(&a);
	picture_finish(&b);
}

static void the_larger_is_scaled_down_exactly(void **state)
{
	(void)state;
	struct picture a = make(6, 3, NULL), b = make(2, 1, NULL);
	for (size_t i = 0; i < 18; i++)
		for (size_t c = 0; c < 3; c++)
			a.rgb[3 * i + c] = (float)(i * (c + 1));
	for (size_t i = 0; i < 6; i++)
		b.rgb[i] = 7;
	struct error err;
	assert_int_equal(metrics_fit(&a, &b, &err), STATUS_OK);
	assert_int_equal(a.width, 2);
	assert_int_equal(a.height, 1);
	// Columns 0…2 of rows starting at 0, 6, 12: mean 7; the right box 3 more.
	const float expected[6] = {7, 14, 21, 10, 20, 30};
	assert_memory_equal(a.rgb, expected, sizeof expected);
	// And the other way round: B is the larger.
	struct picture c = make(1, 1, (const float[3]){1, 1, 1}), d = make(2, 2, NULL);
	for (size_t i = 0; i < 12; i++)
		d.rgb[i] = (float)i;
	assert_int_equal(metrics_fit(&c, &d, &err), STATUS_OK);
	const float quarter[3] = {4.5f, 5.5f, 6.5f};
	assert_memory_equal(d.rgb, quarter, sizeof quarter);
	picture_finish(&a);
	picture_finish(&b);
	picture_finish(&c);
	picture_finish(&d);
}

static void sizes_that_do_not_fit_are_refused(void **state)
{
	(void)state;
	const uint32_t sizes[][4] = {{2, 1, 3, 1}, {4, 2, 2, 2}, {4, 3, 2, 1}, {1, 4, 2, 2}, {6, 4, 4, 6}};
	for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
		struct picture a = make(sizes[i][0], sizes[i][1], NULL), b = make(sizes[i][2], sizes[i][3], NULL);
		struct error err;
		assert_int_equal(metrics_fit(&a, &b, &err), STATUS_BAD_ARGUMENT);
		picture_finish(&a);
		picture_finish(&b);
	}
}

// One colour for another over a whole picture has no features, so FLIP is the mapped distance of the two alone.
static void flip_of_even_pictures_is_that_of_their_colours(void **state)
{
	(void)state;
	static const struct {
		float a[3], b[3];
		double expected;
	} cases[] = {
	    {{0.2f, 0.5f, 0.7f}, {0.2f, 0.5f, 0.7f}, 0},
	    {{0, 1, 0}, {0, 0, 1}, 1}, // what the scale ends with
	    // L* 0 and 100, where green from blue is 203.302: above the knee, 0.95 + 0.05 ((100 / 203.302)^0.7 - 0.4) / 0.6.
	    {{0, 0, 0}, {1, 1, 1}, 0.96738},
	    // L* 53.38896 and 50.02772: below it, (3.36124 / 203.302)^0.7 · 0.95 / 0.4.
	    {{0.2140411f, 0.2140411f, 0.2140411f}, {0.1844187f, 0.1844187f, 0.1844187f}, 0.13444},
	};
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		struct picture a = make(20, 30, NULL), b = make(20, 30, NULL);
		float counts[20 * 30] = {0};
		for (size_t i = 0; i < 20 * 30; i++) {
			memcpy(a.rgb + 3 * i, cases[k].a, sizeof cases[k].a);
			memcpy(b.rgb + 3 * i, cases[k].b, sizeof cases[k].b);
		}
		struct error err;
		struct flip flip;
		assert_int_equal(flip_compare(&a, &b, counts, false, &flip, NULL, &err), STATUS_OK);
		assert_true(fabs(flip.mean - cases[k].expected) <= 1e-4);
		assert_true(fabs(flip.max - flip.mean) <= 1e-6);
		assert_int_equal(flip.exposures, 1);
		picture_finish(&a);
		picture_finish(&b);
	}
}

// A reference that is black, or has values of every size, leaves no NaN and no loop without end.
static void flip_of_extreme_radiance_is_finite(void **state)
{
	(void)state;
	static const float values[] = {0, 1e-30f, 1e-6f, 1, 1e8f, 3e38f, -1};
	const size_t count = sizeof values / sizeof *values;
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < count; k++) {
			struct picture a = make(3, 1, NULL), b = make(3, 1, NULL);
			float counts[3] = {0};
			for (size_t c = 0; c < 9; c++) {
				a.rgb[c] = c < 6 ? values[i] : values[k];
				b.rgb[c] = c < 3 ? values[k] : values[i];
			}
			struct error err;
			struct flip flip;
			assert_int_equal(flip_compare(&a, &b, counts, true, &flip, NULL, &err), STATUS_OK);
			assert_true(flip.mean >= 0 && flip.max <= 1 && flip.mean <= flip.max);
			assert_true(flip.exposures >= 1 && flip.exposures <= FLIP_EXPOSURES_MOST);
			assert_true(isfinite(flip.exposure_low) && isfinite(flip.exposure_high));
			picture_finish(&a);
			picture_finish(&b);
		}
}

static void the_scale_grows_brighter_and_is_logarithmic(void **state)
{
	(void)state;
	double before = -1;
	for (int i = 0; i <= 32; i++) {
		uint8_t c[3];
		heat_colour(i / 32.0, c);
		double y = 0.2126 * view_srgb_decode(c[0] / 255.0) + 0.7152 * view_srgb_decode(c[1] / 255.0) +
			   0.0722 * view_srgb_decode(c[2] / 255.0);
		assert_true(y > before);
		before = y;
	}
	assert_true(before > 0.8);
	CLOSE(heat_position(HEAT_LOW), 0);
	CLOSE(heat_position(sqrt(HEAT_LOW * HEAT_HIGH)), 0.5);
	CLOSE(heat_position(HEAT_HIGH), 1);
	assert_true(heat_position(0) == 0 && heat_position((double)NAN) == 0 && heat_position(1e30) == 1);
}

static void pictures_that_make_no_pair_are_told(void **state)
{
	(void)state;
	const struct origin a = {.scene = "1", .view = "here", .technique = "pt", .seed = 7, .samples = 16};
	const struct {
		struct origin b;
		const char *told[ORIGIN_WARNINGS_MAX]; // NULL: no more
	} cases[] = {
	    {{"1", "here", "pt", "", 8, 0, 16}, {NULL}},
	    {{"2", "there", "pt", "", 8, 0, 16}, {"two scenes"}},
	    {{"1", "there", "pt", "", 8, 0, 16}, {"two cameras"}},
	    {{"1", "here", "pt", "", 7, 12, 64}, {"seed 7 and share samples 12 to 15"}},
	    {{"2", "here", "pt", "", 7, 0, 1}, {"two scenes", "share samples 0 to 0"}},
	    {{"1", "here", "pt", "", 7, 16, 64}, {NULL}},
	    {{"1", "here", "direct", "", 7, 0, 16}, {NULL}},
	    {{"1", "here", "no such", "", 7, 0, 16}, {NULL}},
	    {{"1", "here", "pt", "8x6", 8, 0, 16}, {"time for 8x6 pixels"}},
	    {{"", "", "", "", 0, 0, 0}, {NULL}}, // no picture of ours
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char told[ORIGIN_WARNINGS_MAX][ORIGIN_WARNING_BYTES];
		const unsigned count = origin_compare(&a, &cases[i].b, told);
		for (unsigned k = 0; k < ORIGIN_WARNINGS_MAX && (k < count || cases[i].told[k]); k++)
			if (k >= count || !cases[i].told[k] || !strstr(told[k], cases[i].told[k]))
				fail_msg("case %zu: %s", i, k < count ? told[k] : "nothing is told");
	}
	// Without noise nothing is random.
	const struct origin even = {.technique = "direct", .seed = 7, .samples = 16};
	char told[ORIGIN_WARNINGS_MAX][ORIGIN_WARNING_BYTES];
	assert_int_equal(origin_compare(&even, &even, told), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(pictures_that_make_no_pair_are_told),
	    cmocka_unit_test(figures_are_those_worked_out_by_hand),
	    cmocka_unit_test(masked_and_broken_pixels_are_left_out),
	    cmocka_unit_test(the_larger_is_scaled_down_exactly),
	    cmocka_unit_test(sizes_that_do_not_fit_are_refused),
	    cmocka_unit_test(flip_of_even_pictures_is_that_of_their_colours),
	    cmocka_unit_test(flip_of_extreme_radiance_is_finite),
	    cmocka_unit_test(the_scale_grows_brighter_and_is_logarithmic),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
