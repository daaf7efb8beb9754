// An alias table draws each entry in proportion to its weight, says so in its pmf, and does not change when all weights
// double.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/scene/alias.h"

#define MOST 5000

static struct alias_row rows[MOST], others[MOST];
static double weights[MOST], drawn[MOST];

// A fixed sequence of numbers in 0…1.
static double next(uint64_t *state)
{
	*state = *state * 6364136223846793005ull + 1442695040888963407ull;
	return (double)(*state >> 11) / 9007199254740992.0;
}

static double fill(size_t count, uint64_t seed, double decades)
{
	double sum = 0;
	for (size_t i = 0; i < count; i++) {
		weights[i] = pow(10.0, decades * (next(&seed) - 0.5));
		sum += weights[i];
	}
	return sum;
}

// What the rows draw, entry by entry, by going through all of them.
static void enumerate(size_t count)
{
	memset(drawn, 0, sizeof drawn);
	for (size_t i = 0; i < count; i++) {
		assert_true(rows[i].alias < count);
		assert_true(rows[i].keep >= 0 && rows[i].keep <= 1);
		drawn[i] += (double)rows[i].keep / (double)count;
		drawn[rows[i].alias] += (1.0 - (double)rows[i].keep) / (double)count;
	}
}

static void check_table(size_t count, uint64_t seed, double decades)
{
	double sum, total = 0;
	const double expected = fill(count, seed, decades);
	assert_int_equal(alias_build(weights, count, rows, &sum, NULL), STATUS_OK);
	assert_true(fabs(sum / expected - 1) < 1e-12);
	enumerate(count);
	for (size_t i = 0; i < count; i++) {
		// A row's own rounding is one part in 2^24 of 1 / count.
		assert_true(fabs(drawn[i] - weights[i] / sum) < 1e-6 / (double)count + 1e-6 * weights[i] / sum);
		assert_true(fabs((double)rows[i].pmf - drawn[i]) <= 1e-7 * drawn[i]);
		total += rows[i].pmf;
	}
	assert_true(fabs(total - 1) < 1e-6);
}

static void tables_draw_by_weight(void **state)
{
	(void)state;
	check_table(1, 1, 3);
	check_table(2, 2, 3);
	check_table(3, 3, 0);
	check_table(100, 4, 6);
	check_table(MOST, 5, 1);
	check_table(MOST, 6, 10);
}

static void doubling_changes_no_bit(void **state)
{
	double sum, twice;
	(void)state;
	fill(MOST, 7, 8);
	assert_int_equal(alias_build(weights, MOST, rows, &sum, NULL), STATUS_OK);
	for (size_t i = 0; i < MOST; i++)
		weights[i] *= 2;
	assert_int_equal(alias_build(weights, MOST, others, &twice, NULL), STATUS_OK);
	assert_memory_equal(rows, others, sizeof rows);
	assert_true(twice == 2 * sum);
}

static void equal_weights_keep_every_row(void **state)
{
	double sum;
	(void)state;
	for (size_t i = 0; i < 7; i++)
		weights[i] = 0.1;
	assert_int_equal(alias_build(weights, 7, rows, &sum, NULL), STATUS_OK);
	for (size_t i = 0; i < 7; i++)
		assert_true(rows[i].pmf > 0.142857f && rows[i].pmf < 0.142858f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(tables_draw_by_weight),
	    cmocka_unit_test(doubling_changes_no_bit),
	    cmocka_unit_test(equal_weights_keep_every_row),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
