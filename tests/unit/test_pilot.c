// A pilot's word on the bias of a picture beside two noisy halves.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "server/worker/pilot/pilot.h"

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

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(noise_is_no_bias),
	    cmocka_unit_test(bias_shows_behind_noise),
	    cmocka_unit_test(one_firefly_is_not_the_picture),
	    cmocka_unit_test(no_number_is_no_answer),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
