#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "server/worker/image/view.h"

#define CLOSE(got, expected, tolerance) assert_true(fabs((double)(got) - (expected)) <= (tolerance))

static void codes(enum codec_view view, double ev, float r, float g, float b, int er, int eg, int eb)
{
	uint8_t out[3];
	view_srgb8(view, ev, (const float[3]){r, g, b}, out);
	assert_int_equal(out[0], er);
	assert_int_equal(out[1], eg);
	assert_int_equal(out[2], eb);
}

static void srgb_curve_has_the_standard_values(void **state)
{
	(void)state;
	CLOSE(view_srgb_encode(0), 0, 0);
	CLOSE(view_srgb_encode(1), 1, 1e-12);
	CLOSE(view_srgb_encode(0.5), 0.735357, 1e-6);
	CLOSE(view_srgb_encode(0.18), 0.461356, 1e-6);
	CLOSE(view_srgb_encode(0.001), 0.01292, 1e-12); // on the straight part
	for (int code = 0; code < 256; code++)
		CLOSE(view_srgb_encode(view_srgb_decode(code / 255.0)), code / 255.0, 1e-7);
}

static void none_clips_and_encodes(void **state)
{
	(void)state;
	codes(CODEC_VIEW_NONE, 0, 0, 0.5f, 1, 0, 188, 255);
	codes(CODEC_VIEW_NONE, 0, -1, 7, 0.18f, 0, 255, 118);
	codes(CODEC_VIEW_NONE, 1, 0.25f, 0.5f, 0.09f, 188, 255, 118); // one stop up doubles
	codes(CODEC_VIEW_NONE, -2, 2, 4, 0.72f, 188, 255, 118);
}

static void reinhard_divides_by_one_plus_luminance(void **state)
{
	(void)state;
	double out[3];
	view_apply(CODEC_VIEW_REINHARD, 0, (const float[3]){1, 1, 1}, out);
	for (int i = 0; i < 3; i++)
		CLOSE(out[i], 0.5, 1e-12);
	// Luminance of (0, 1, 0) is 0.7152, and the ratios of channels stay.
	view_apply(CODEC_VIEW_REINHARD, 0, (const float[3]){0.5f, 1, 0.25f}, out);
	double luminance = 0.2126 * 0.5 + 0.7152 + 0.0722 * 0.25;
	CLOSE(out[1], 1 / (1 + luminance), 1e-12);
	CLOSE(out[0] / out[1], 0.5, 1e-12);
	CLOSE(out[2] / out[1], 0.25, 1e-12);
}

static void filmic_goes_from_black_to_white_without_turning(void **state)
{
	(void)state;
	double out[3];
	view_apply(CODEC_VIEW_FILMIC, 0, (const float[3]){0, 5.6f, 1}, out);
	CLOSE(out[0], 0, 1e-12);
	CLOSE(out[1], 1, 1e-7); // 2 · 5.6 is the white point
	// x = 2: (2(0.3 + 0.05) + 0.004) / (2(0.3 + 0.5) + 0.06) − 1/15 = 0.357430; at 11.2: 0.725129.
	CLOSE(out[2], 0.492919, 1e-5);
	double before = -1;
	for (float x = 0; x < 6; x += 0.05f) {
		view_apply(CODEC_VIEW_FILMIC, 0, (const float[3]){x, x, x}, out);
		assert_true(out[0] >= before);
		before = out[0];
	}
}

static void extremes_stay_in_range(void **state)
{
	(void)state;
	for (int v = CODEC_VIEW_NONE; v <= CODEC_VIEW_FILMIC; v++) {
		double out[3];
		view_apply((enum codec_view)v, 1000, (const float[3]){INFINITY, FLT_MAX, NAN}, out);
		for (int i = 0; i < 3; i++)
			assert_true(out[i] >= 0 && out[i] <= 1);
		assert_true(out[2] == 0);
		assert_true(out[0] > 0);
		view_apply((enum codec_view)v, -1e9, (const float[3]){-INFINITY, 1, -0.0f}, out);
		for (int i = 0; i < 3; i++)
			assert_true(out[i] == 0);
	}
}

static void same_codes(const struct view_table *table, enum codec_view view, double ev, float x)
{
	uint8_t by_table[3], alone[3];
	const float rgb[3] = {x, 0.5f * x, 0.01f};
	view_table_srgb8(table, rgb, by_table);
	view_srgb8(view, ev, rgb, alone);
	assert_memory_equal(by_table, alone, sizeof alone);
}

// At every code's least value and the floats beside it, and at values of all sizes.
static void a_table_gives_the_same_codes(void **state)
{
	const enum codec_view views[] = {CODEC_VIEW_NONE, CODEC_VIEW_REINHARD, CODEC_VIEW_FILMIC};
	(void)state;
	for (unsigned v = 0; v < 3; v++)
		for (double ev = -20; ev <= 20; ev += 2.5) {
			struct view_table table;
			view_table_init(&table, views[v], ev);
			for (unsigned code = 1; code < 256; code++) {
				float x = (float)(table.least[code] / table.scale);
				for (int i = 0; i < 5; i++)
					x = nextafterf(x, 0);
				for (int i = 0; i < 10; i++, x = nextafterf(x, FLT_MAX))
					same_codes(&table, views[v], ev, x);
			}
			for (float x = 1e-12f; x < 1e12f; x *= 1.003f)
				same_codes(&table, views[v], ev, x);
			const float odd[] = {0, -0.0f, -1, FLT_MAX, INFINITY, -INFINITY, NAN, FLT_MIN, 1e-45f};
			for (unsigned i = 0; i < sizeof odd / sizeof *odd; i++)
				same_codes(&table, views[v], ev, odd[i]);
		}
}

// The curve rises, so that a code is that of a range.
static void a_table_has_the_least_of_each_code(void **state)
{
	struct view_table table;
	(void)state;
	view_table_init(&table, CODEC_VIEW_NONE, 0);
	for (unsigned code = 1; code < 256; code++) {
		assert_int_equal(lround(255 * view_srgb_encode(table.least[code])), code);
		assert_int_equal(lround(255 * view_srgb_encode(nextafter(table.least[code], 0))), code - 1);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(srgb_curve_has_the_standard_values),
	    cmocka_unit_test(none_clips_and_encodes),
	    cmocka_unit_test(reinhard_divides_by_one_plus_luminance),
	    cmocka_unit_test(filmic_goes_from_black_to_white_without_turning),
	    cmocka_unit_test(extremes_stay_in_range),
	    cmocka_unit_test(a_table_gives_the_same_codes),
	    cmocka_unit_test(a_table_has_the_least_of_each_code),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
