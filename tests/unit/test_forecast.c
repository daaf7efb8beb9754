// What pieces of a pass are forecast to take: against sums by hand, and against passes whose units' costs are drawn here,
// under a deadline, with a clock that is their sum.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "server/worker/plan/forecast.h"
#include "server/worker/plan/plan.h"

#define UNITS 4096u
#define N (1 / PLAN_PIECE)

static double costs[UNITS]; // of each unit, µs

static void assert_near(double a, double b, double apart)
{
	if (!(fabs(a - b) <= apart))
		fail_msg("%g is not %g", a, b);
}

static double sum(uint32_t first, uint32_t count)
{
	double us = 0;
	for (uint32_t i = first; i < first + count; i++)
		us += costs[i];
	return us;
}

static uint32_t seed;

// 0…1, Numerical Recipes' linear congruence.
static double any(void)
{
	seed = seed * 1664525u + 1013904223u;
	return (double)(seed >> 8) * 0x1p-24;
}

static void a_profile_is_that_of_its_pieces(void **unused)
{
	struct forecast f = {0};
	(void)unused;
	forecast_begin(&f, UNITS);
	assert_near(forecast_us(&f, 0, UNITS), 0, 0);
	assert_int_equal(forecast_fit(&f, 0, 100, 1), 100);
	for (uint32_t i = 0; i < UNITS; i++)
		costs[i] = i < UNITS / 4 ? 400 : 7; // as where a quarter of the tiles have all the work
	for (uint32_t i = 0; i < UNITS; i += 64)
		forecast_add(&f, i, 64, sum(i, 64));
	// Whatever the last pieces took, the first are as dear as they were.
	for (uint32_t first = 0; first < UNITS; first += 100)
		for (uint32_t count = 1; first + count <= UNITS; count += 333)
			assert_near(forecast_us(&f, first, count), sum(first, count), 1e-3 * sum(first, count));
	assert_int_equal(forecast_fit(&f, 0, UNITS, 4000), 10);
	assert_int_equal(forecast_fit(&f, UNITS / 2, 30, 1e9), 30);
	assert_int_equal(forecast_fit(&f, 0, UNITS, 1), 1);
	assert_int_equal(forecast_fit(&f, 0, UNITS, -1), 1);
	assert_int_equal(forecast_fit(&f, 0, 0, 1e9), 0);
}

static void few_units_are_parts_of_their_own(void **unused)
{
	(void)unused;
	for (uint32_t units = 1; units <= 300; units += 7) {
		struct forecast f = {0};
		forecast_begin(&f, units);
		for (uint32_t i = 0; i < units; i++)
			forecast_add(&f, i, 1, 10 + i);
		for (uint32_t i = 0; units <= FORECAST_BINS && i < units; i++)
			assert_near(forecast_us(&f, i, 1), 10 + i, 1e-3);
		assert_near(forecast_us(&f, 0, units), units * 10.0 + units * (units - 1) / 2.0, 0.02 * units * units);
	}
}

// Even if it took nothing before.
static void what_costs_change_to_is_learnt(void **unused)
{
	struct forecast f = {0};
	(void)unused;
	forecast_begin(&f, UNITS);
	for (int turn = 0; turn < 40; turn++)
		for (uint32_t i = 0; i < UNITS; i += 512)
			forecast_add(&f, i, 512, turn < 20 ? 0 : 512 * 30);
	assert_near(forecast_us(&f, 0, UNITS), 30.0 * UNITS, 30);
}

static void where_nothing_was_seen_the_dearest_counts(void **unused)
{
	struct forecast f = {0};
	(void)unused;
	forecast_begin(&f, UNITS);
	forecast_add(&f, 0, 128, 128 * 50.0);
	forecast_add(&f, 128, 128, 128 * 300.0);
	for (uint32_t i = 256; i < 1024; i += 128)
		forecast_add(&f, i, 128, 128 * 1.0);
	assert_near(forecast_us(&f, 0, 10), 500, 1e-3);
	assert_near(forecast_us(&f, 1100, 10), 3000, 1e-3);
	// And at another picture, until its own are known; begun again for want of memory, too.
	for (int again = 0; again < 2; again++) {
		forecast_begin(&f, 4 * UNITS);
		assert_near(forecast_us(&f, 0, 4 * UNITS), 300.0 * 4 * UNITS, 1);
		assert_int_equal(forecast_fit(&f, 0, UNITS, 3000), 10);
	}
	for (uint32_t i = 0; i < 4 * UNITS; i += 128)
		forecast_add(&f, i, 128, 128 * 10.0);
	assert_near(forecast_us(&f, 0, 4 * UNITS), 10.0 * 4 * UNITS, 1);
	// A piece takes as long as the shortest did, though a unit takes less.
	assert_near(forecast_least_us(&f, 4000), 1280, 1e-3);
	forecast_add(&f, 4000, 1, 90);
	assert_near(forecast_least_us(&f, 0), 90, 1e-3);
	// That piece was one unit of 64 in its part.
	assert_near(forecast_us(&f, 3968, 64), 640 + 80, 1e-3);
}

static void cheap_parts_are_sized_by_the_mean(void **unused)
{
	struct forecast f = {0};
	(void)unused;
	forecast_begin(&f, UNITS);
	forecast_add(&f, 0, UNITS / 2, 1);
	forecast_add(&f, UNITS / 2, UNITS / 2, UNITS / 2 * 200.0);
	assert_int_equal(forecast_fit(&f, 0, UNITS, 1001), 10);
	assert_int_equal(forecast_fit(&f, UNITS / 2, UNITS, 1001), 5);
}

// ---- under a deadline ---------------------------------------------------------------------------------------------------

// Costs of which none is more than N times the mean.
static double even(uint32_t unit)
{
	(void)unit;
	return 100;
}

static double sky_first(uint32_t unit)
{
	return unit < 3 * UNITS / 4 ? 0 : 400;
}

static double sky_last(uint32_t unit)
{
	return unit < UNITS / 4 ? 400 : 0;
}

static double floor_last(uint32_t unit)
{
	return unit < UNITS / 2 ? 400 * any() : 20 * any();
}

static double rows(uint32_t unit)
{
	return unit / 64 % 4 == 3 ? 400 : 0;
}

static double stripes(uint32_t unit)
{
	return unit % 4 == 3 ? 400 : 0;
}

static double chance(uint32_t unit)
{
	(void)unit;
	return 200 * any();
}

// As a technique's job goes on until `end`, from the first sample on. No piece but one of a single unit ends beyond it.
static void keep(uint64_t end_us, double dearest)
{
	const struct plan plan = {.end_us = end_us};
	struct forecast f = {0};
	double now = 1;
	// The attempt before it, of which the mean is known.
	forecast_begin(&f, 64);
	forecast_add(&f, 0, 64, 64 * sum(0, UNITS) / UNITS);
	forecast_begin(&f, UNITS);
	for (uint32_t unit = 0; plan_fits(&plan, (uint64_t)now, forecast_us(&f, unit, 1));) {
		const double piece_us = plan_piece_us(&plan, (uint64_t)now, 50000);
		const uint32_t count = forecast_fit(&f, unit, UNITS - unit, piece_us);
		const double us = sum(unit, count);
		assert_true(count == 1 || now + us <= (double)end_us + 1);
		assert_true(now + us <= (double)end_us + dearest);
		forecast_add(&f, unit, count, us);
		now += us;
		unit = unit + count < UNITS ? unit + count : 0;
	}
	// Nor is much time left over.
	assert_true((double)end_us - now <= dearest);
}

static void no_piece_ends_beyond_the_end(void **unused)
{
	double (*const fields[])(uint32_t) = {even, sky_first, sky_last, floor_last, rows, stripes, chance};
	(void)unused;
	for (unsigned i = 0; i < sizeof fields / sizeof *fields; i++)
		for (uint32_t turn = 0; turn < 40; turn++) {
			double dearest = 0;
			seed = 1000 * i + turn;
			for (uint32_t k = 0; k < UNITS; k++) {
				costs[k] = fields[i](k);
				dearest = fmax(dearest, costs[k]);
			}
			const double mean = sum(0, UNITS) / UNITS;
			assert_true(dearest <= 1.01 * N * mean);
			keep((uint64_t)(3 * any() * mean * UNITS) + 2, dearest);
		}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_profile_is_that_of_its_pieces),   cmocka_unit_test(few_units_are_parts_of_their_own),
	    cmocka_unit_test(what_costs_change_to_is_learnt),    cmocka_unit_test(where_nothing_was_seen_the_dearest_counts),
	    cmocka_unit_test(cheap_parts_are_sized_by_the_mean), cmocka_unit_test(no_piece_ends_beyond_the_end),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
