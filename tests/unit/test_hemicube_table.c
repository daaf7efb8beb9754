// The shares of a hemicube's pixels: their closed form beside sums over small parts, all pixels together 1, and whole
// numbers that sum up to their unit.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/base/angle.h"
#include "server/worker/technique/radiosity/hemicube_table.h"

#define UNIT 3000000008u // a multiple of 8

static const uint32_t sizes[] = {2, 16, 32, 64, 128, 256, 512, 1024};

static double sum_of(const double *table, uint32_t n)
{
	const uint32_t part = n * n / 4;
	double top = 0, side = 0;
	for (uint32_t i = 0; i < part; i++) {
		top += table[i];
		side += table[part + i];
	}
	return 4 * top + 8 * side;
}

static void pixels_sum_up_to_one(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
		double *table;
		assert_int_equal(hemicube_table_make(sizes[i], false, &table, NULL), STATUS_OK);
		printf("%u: 1 %+.1e\n", sizes[i], sum_of(table, sizes[i]) - 1);
		assert_true(fabs(sum_of(table, sizes[i]) - 1) < 1e-12);
		for (uint32_t k = 0; k < hemicube_table_entries(sizes[i]); k++)
			assert_true(table[k] > 0);
		free(table);
	}
}

// 64² points in each pixel.
static double by_points(double a, double b, double side, int on_side)
{
	double sum = 0;
	for (int i = 0; i < 64; i++)
		for (int k = 0; k < 64; k++) {
			const double x = a + (i + 0.5) / 64 * side, y = b + (k + 0.5) / 64 * side, d = x * x + y * y + 1;
			sum += (on_side ? y : 1) / (PI * d * d);
		}
	return sum * side * side / 4096;
}

static void a_pixel_has_its_integral(void **state)
{
	(void)state;
	const uint32_t n = 8, half = n / 2;
	double *table;
	assert_int_equal(hemicube_table_make(n, false, &table, NULL), STATUS_OK);
	for (uint32_t y = 0; y < half; y++)
		for (uint32_t x = 0; x < half; x++)
			for (uint32_t side = 0; side < 2; side++) {
				const double is = table[(side * half + y) * half + x];
				assert_true(fabs(is / by_points(0.25 * x, 0.25 * y, 0.25, (int)side) - 1) < 1e-4);
			}
	free(table);
}

// 5·10⁻⁴ too much at 32²: what papers print.
static void products_of_middles_are_too_high(void **state)
{
	(void)state;
	double *table;
	assert_int_equal(hemicube_table_make(32, true, &table, NULL), STATUS_OK);
	printf("middles at 32: 1 %+.3e\n", sum_of(table, 32) - 1);
	assert_true(sum_of(table, 32) > 1.0004 && sum_of(table, 32) < 1.0006);
	free(table);
}

static void whole_numbers_sum_up_to_their_unit(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
		const uint32_t n = sizes[i], all = hemicube_table_entries(n);
		double *table, off = 0, run = 0;
		uint32_t *words = malloc(all * sizeof *words);
		uint64_t sum = 0;
		assert_non_null(words);
		assert_int_equal(hemicube_table_make(n, false, &table, NULL), STATUS_OK);
		hemicube_table_round(n, table, UNIT, words);
		for (uint32_t k = 0; k < all; k++) {
			sum += (k < all / 2 ? 4 : 8) * (uint64_t)words[k];
			run = k == all / 2 ? 0 : run;
			run += words[k] - table[k] * UNIT;
			off = fmax(off, fabs(run));
		}
		assert_int_equal(sum, UNIT);
		assert_true(off < 3);
		free(table);
		free(words);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(pixels_sum_up_to_one),
	    cmocka_unit_test(a_pixel_has_its_integral),
	    cmocka_unit_test(products_of_middles_are_too_high),
	    cmocka_unit_test(whole_numbers_sum_up_to_their_unit),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
