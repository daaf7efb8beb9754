// The statistics of a report against tables and closed forms.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/report/statistics.h"

static void assert_near(double a, double b, double within)
{
	if (!(fabs(a - b) <= within))
		fail_msg("%.17g is not %.17g", a, b);
}

static void student_is_as_in_tables(void **state)
{
	(void)state;
	// With one degree of freedom Cauchy's, with two a root; the rest from tables of two-sided 5 % and 1 %.
	assert_near(statistics_student(1, 1), 0.5, 1e-12);
	assert_near(statistics_student(3, 2), 1 - 3 / sqrt(11), 1e-12);
	assert_near(statistics_student(2.364624251592785, 7), 0.05, 1e-10);
	assert_near(statistics_student(-2.364624251592785, 7), 0.05, 1e-10);
	assert_near(statistics_student(3.169272672616951, 10), 0.01, 1e-10);
	assert_near(statistics_student(1.959963984540054, 1e9), 0.05, 1e-7);
	assert_near(statistics_student(0, 5), 1, 1e-12);
	assert_true(statistics_student(1e9, 30) < 1e-100);
}

static void welch_is_students_where_variances_are_equal(void **state)
{
	(void)state;
	// Two samples of 8: the pooled test has 14 degrees.
	struct sample_mean a = {1, 0.5 / 8, 7}, b = {0, 0.5 / 8, 7};
	assert_near(statistics_welch(a, b), statistics_student(1 / sqrt(0.125), 14), 1e-12);
	// One sample against a value without noise has its own 7.
	b.variance = 0;
	assert_near(statistics_welch(a, b), statistics_student(1 / sqrt(0.0625), 7), 1e-12);
	a.variance = 0;
	assert_true(statistics_welch(a, b) == 0);
	b.value = 1;
	assert_true(statistics_welch(a, b) == 1);
}

static void discoveries_are_benjamini_and_hochbergs(void **state)
{
	(void)state;
	// The example of their paper, table 1: four of fifteen at 5 %.
	const double p[] = {0.0001, 0.0004, 0.0019, 0.0095, 0.0201, 0.0278, 0.0298, 0.0344,
			    0.0459, 0.3240, 0.4262, 0.5719, 0.6528, 0.7590, 1.0000};
	bool found[15];
	assert_int_equal(statistics_discoveries(p, 15, 0.05, found), 4);
	assert_true(found[3] && !found[4]);
	const double none[] = {0.2, 0.4, 0.9};
	assert_int_equal(statistics_discoveries(none, 3, 0.05, found), 0);
	assert_int_equal(statistics_discoveries(none, 0, 0.05, found), 0);
}

static void medians_and_variances(void **state)
{
	(void)state;
	double odd[] = {3, 1, 2}, even[] = {4, 1, 3, 2};
	assert_near(statistics_median(odd, 3), 2, 0);
	assert_near(statistics_median(even, 4), 2.5, 0);
	assert_true(isnan(statistics_median(odd, 0)));
	assert_near(statistics_variance(odd, 3), 1, 1e-15);
	assert_true(isnan(statistics_variance(odd, 1)));
	assert_true(isnan(statistics_mean(odd, 0)));
}

static uint64_t seed;

static double uniform(void)
{
	seed = seed * 6364136223846793005u + 1442695040888963407u;
	return ((double)(seed >> 11) + 0.5) * 0x1p-53;
}

static double normal(void)
{
	const double radius = sqrt(-2 * log(uniform())), turn = 6.283185307179586 * uniform();
	return radius * cos(turn);
}

// Errors of seeds: `kind` 0 normal with a tenth of the mean, 1 and 2 lognormal, skewed a little and much. The mean is 1.
static double error_of_a_seed(int kind)
{
	const double sigma = kind == 1 ? 0.3 : 0.8;
	return kind == 0 ? 1 + 0.1 * normal() : exp(sigma * normal() - sigma * sigma / 2);
}

static void intervals_hold_the_mean_as_often_as_they_say(void **state)
{
	(void)state;
	// 95 % is said. Of 1000 intervals a standard deviation is 0.7 %; below 90 % they would say too much.
	static const size_t counts[] = {2, 3, 4, 8, 16};
	seed = 1;
	for (int kind = 0; kind < 3; kind++)
		for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
			unsigned held = 0;
			for (int trial = 0; trial < 1000; trial++) {
				double values[16];
				for (size_t i = 0; i < counts[c]; i++)
					values[i] = error_of_a_seed(kind);
				const struct interval interval = statistics_mean_interval(values, counts[c]);
				held += interval.low <= 1 && 1 <= interval.high;
			}
			if (held < 900 || held > 990)
				fail_msg("%u of 1000 intervals of %zu values of kind %d hold the mean", held, counts[c],
					 kind);
		}
}

static void intervals_hold_the_median(void **state)
{
	(void)state;
	static const size_t counts[] = {3, 4, 8};
	seed = 2;
	for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
		unsigned held = 0;
		for (int trial = 0; trial < 1000; trial++) {
			double values[8];
			for (size_t i = 0; i < counts[c]; i++)
				values[i] = exp(0.3 * normal());
			const struct interval interval = statistics_median_interval(values, counts[c]);
			held += interval.low <= 1 && 1 <= interval.high;
		}
		assert_in_range(held, 900, 990);
	}
}

static void student_quantiles_are_as_in_tables(void **state)
{
	(void)state;
	assert_near(statistics_student_quantile(0.05, 1), 12.706204736432095, 1e-8);
	assert_near(statistics_student_quantile(0.05, 7), 2.364624251592785, 1e-9);
	assert_near(statistics_student_quantile(0.01, 10), 3.169272672616951, 1e-9);
}

static void intervals_are_the_same_every_time(void **state)
{
	(void)state;
	double values[] = {1, 2, 4, 8, 16, 32, 64, 128};
	const struct interval first = statistics_mean_interval(values, 8), second = statistics_mean_interval(values, 8);
	assert_true(first.low == second.low && first.high == second.high && first.low < first.high);
	assert_true(isnan(statistics_mean_interval(values, 1).low) && isnan(statistics_median_interval(values, 1).low));
	const struct interval median = statistics_median_interval(values, 8);
	assert_true(median.low >= 1 && median.high <= 128 && median.low < median.high);
	assert_true(values[0] == 1 && values[7] == 128);
	// Of equal values there is no width, of values that may be 0 or less there is no logarithm.
	const double equal[] = {0.1, 0.1, 0.1}, signs[] = {-1, 0, 1};
	assert_true(statistics_mean_interval(equal, 3).low == 0.1 && statistics_mean_interval(equal, 3).high == 0.1);
	assert_near(statistics_mean_interval(signs, 3).high, 4.302652729696142 / sqrt(3), 1e-8);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(student_is_as_in_tables),
	    cmocka_unit_test(welch_is_students_where_variances_are_equal),
	    cmocka_unit_test(discoveries_are_benjamini_and_hochbergs),
	    cmocka_unit_test(medians_and_variances),
	    cmocka_unit_test(student_quantiles_are_as_in_tables),
	    cmocka_unit_test(intervals_hold_the_mean_as_often_as_they_say),
	    cmocka_unit_test(intervals_hold_the_median),
	    cmocka_unit_test(intervals_are_the_same_every_time),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
