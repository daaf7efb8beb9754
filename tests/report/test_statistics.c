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

static void bootstrap_holds_the_mean_as_often_as_it_says(void **state)
{
	(void)state;
	// Means of 40 uniform numbers; the truth is 1/2. 400 intervals of 95 %: 4 standard deviations are 4.4 %.
	uint64_t seed = 1;
	unsigned held = 0;
	for (int trial = 0; trial < 400; trial++) {
		double values[40];
		for (int i = 0; i < 40; i++) {
			seed = seed * 6364136223846793005u + 1442695040888963407u;
			values[i] = (double)(seed >> 11) * 0x1p-53;
		}
		const struct interval interval = statistics_bootstrap_mean(values, 40);
		held += interval.low <= 0.5 && 0.5 <= interval.high;
	}
	assert_in_range(held, 360, 398);
}

static void bootstrap_is_the_same_every_time(void **state)
{
	(void)state;
	double values[] = {1, 2, 4, 8, 16, 32, 64, 128};
	const struct interval first = statistics_bootstrap_mean(values, 8), second = statistics_bootstrap_mean(values, 8);
	assert_true(first.low == second.low && first.high == second.high && first.low < first.high);
	assert_true(isnan(statistics_bootstrap_mean(values, 1).low));
	const struct interval median = statistics_bootstrap_median(values, 8);
	assert_true(median.low >= 1 && median.high <= 128 && median.low < median.high);
	assert_true(values[0] == 1 && values[7] == 128);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(student_is_as_in_tables),
	    cmocka_unit_test(welch_is_students_where_variances_are_equal),
	    cmocka_unit_test(discoveries_are_benjamini_and_hochbergs),
	    cmocka_unit_test(medians_and_variances),
	    cmocka_unit_test(bootstrap_holds_the_mean_as_often_as_it_says),
	    cmocka_unit_test(bootstrap_is_the_same_every_time),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
