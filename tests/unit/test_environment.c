// The table over a picture of the surroundings: it is one, its densities are those with which it draws, nothing bright is
// left out, and its power is the light of all directions.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/loader/environment.h"

#include "server/base/angle.h"

#define WIDTH 48u
#define HEIGHT 24u
#define TEXELS (WIDTH * HEIGHT)

static float rgb[3 * TEXELS];
static double drawn[TEXELS];
static struct files files;
static candil_SceneInfo info;
static struct import import;

static int begin(void **state)
{
	(void)state;
	import_init(&import, &files, &info);
	import.environment_width = WIDTH;
	import.environment_height = HEIGHT;
	memset(rgb, 0, sizeof rgb);
	return 0;
}

static int end(void **state)
{
	(void)state;
	import_finish(&import);
	return 0;
}

static double solid_angle(uint32_t row)
{
	return 2 * PI / WIDTH * (cos(PI * row / HEIGHT) - cos(PI * (row + 1) / HEIGHT));
}

static void set(uint32_t x, uint32_t y, float value)
{
	for (int c = 0; c < 3; c++)
		rgb[3 * (y * WIDTH + x) + (uint32_t)c] = value;
}

// What the rows draw, and that the texels' densities say so.
static void check_table(void)
{
	double sum = 0;
	assert_int_equal(environment_build(&import, rgb, NULL), STATUS_OK);
	memset(drawn, 0, sizeof drawn);
	for (uint32_t i = 0; i < TEXELS; i++) {
		const struct environment_row *r = &import.environment_rows[i];
		assert_true(r->keep >= 0 && r->keep <= 1 && r->alias < TEXELS);
		drawn[i] += (double)r->keep / TEXELS;
		drawn[r->alias] += (1 - (double)r->keep) / TEXELS;
	}
	for (uint32_t i = 0; i < TEXELS; i++) {
		const double mass = (double)import.environment[i].pdf * solid_angle(i / WIDTH);
		assert_true(fabs(mass - drawn[i]) <= 1e-6 * drawn[i] + 1e-12);
		sum += mass;
	}
	assert_true(fabs(sum - 1) < 1e-6);
}

static void an_even_sky_is_drawn_evenly(void **state)
{
	(void)state;
	for (uint32_t i = 0; i < 3 * TEXELS; i++)
		rgb[i] = 2;
	check_table();
	for (uint32_t i = 0; i < TEXELS; i++)
		assert_true(fabs((double)import.environment[i].pdf * 4 * PI - 1) < 1e-5);
	assert_true(fabs((double)import.environment_power / (8 * PI) - 1) < 1e-6);
	assert_true(fabs((double)import.environment_contrast - 1) < 1e-5);
}

static void a_spot_has_its_neighbours(void **state)
{
	(void)state;
	set(0, 5, 1000);
	check_table();
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++) {
			const bool near = (x <= 1 || x == WIDTH - 1) && y >= 4 && y <= 6;
			assert_int_equal(import.environment[y * WIDTH + x].pdf > 0, near);
		}
	// Of what is bilinear three quarters each way are its own, and an eighth is each neighbour's.
	const double lines = 0.75 * solid_angle(5) + 0.125 * (solid_angle(4) + solid_angle(6));
	assert_true(fabs(drawn[5 * WIDTH] - 0.75 * 0.75 * solid_angle(5) / lines) < 1e-6);
	assert_true(fabs(drawn[4 * WIDTH + 1] - 0.125 * 0.125 * solid_angle(4) / lines) < 1e-6);
	double squares = 0;
	for (uint32_t i = 0; i < TEXELS; i++)
		squares += drawn[i] * drawn[i] / solid_angle(i / WIDTH);
	assert_true(fabs((double)import.environment_contrast / (4 * PI * squares) - 1) < 1e-5);
}

static void many_decades(void **state)
{
	uint64_t seed = 7;
	(void)state;
	for (uint32_t i = 0; i < 3 * TEXELS; i++) {
		seed = seed * 6364136223846793005ull + 1442695040888963407ull;
		rgb[i] = (float)pow(10, 16 * (double)(seed >> 40) / 16777216 - 8);
	}
	check_table();
}

static void a_black_sky_has_a_table_and_no_power(void **state)
{
	(void)state;
	check_table();
	assert_true(import.environment_power == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test_setup_teardown(an_even_sky_is_drawn_evenly, begin, end),
	    cmocka_unit_test_setup_teardown(a_spot_has_its_neighbours, begin, end),
	    cmocka_unit_test_setup_teardown(many_decades, begin, end),
	    cmocka_unit_test_setup_teardown(a_black_sky_has_a_table_and_no_power, begin, end),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
