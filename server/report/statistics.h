// The statistics of a report. Double precision; pure functions, any thread. The same values give the same figures: whatever
// is drawn by chance comes from one generator that begins anew, with STATISTICS_SEED, at each call. A value that cannot be
// known is NaN, never 0.
#ifndef CANDIL_REPORT_STATISTICS_H
#define CANDIL_REPORT_STATISTICS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define STATISTICS_SEED 20200709u
#define STATISTICS_RESAMPLES 2000u
#define STATISTICS_SHARE 0.95 // of an interval

struct interval {
	double low, high;
};

double statistics_mean(const double *values, size_t count); // NaN of none

// The unbiased variance; NaN of fewer than two.
double statistics_variance(const double *values, size_t count);

// The middle value, of two the mean of both; NaN of none. Sorts `values`.
double statistics_median(double *values, size_t count);

// A figure of the values that `pick` (count indices) picks out.
typedef double (*statistics_figure)(const void *context, const size_t *pick, size_t count);

// The interval of a figure by the bootstrap's percentiles: the figure of STATISTICS_RESAMPLES draws of `count` out of
// `count` indices with replacement, of which the middle STATISTICS_SHARE lies inside (Efron, "Bootstrap methods: another
// look at the jackknife", Annals of Statistics 7(1), 1979; percentiles: Efron and Tibshirani, "An Introduction to the
// Bootstrap", 1993, section 13.3). It is somewhat narrow for few values: 8 normal ones hold the truth in some 90 % of cases.
// NaN of fewer than two values, and without memory.
struct interval statistics_bootstrap(statistics_figure figure, const void *context, size_t count);

// That of the mean and that of the median.
struct interval statistics_bootstrap_mean(const double *values, size_t count);
struct interval statistics_bootstrap_median(const double *values, size_t count);

// The probability that Student's t with `freedom` degrees, freedom > 0, is further from 0 than `t` is:
// I_x(ν/2, 1/2) with x = ν / (ν + t²) (NIST Digital Library of Mathematical Functions, 8.17).
double statistics_student(double t, double freedom);

// A mean that is known from a sample: its value, the variance of that value, and the degrees of freedom of that variance.
// A value without noise has variance 0.
struct sample_mean {
	double value, variance, freedom;
};

// Welch's test of whether two means differ: the probability of a difference as large or larger if they are equal, with the
// degrees of freedom of Welch and Satterthwaite (Welch, "The generalization of 'Student's' problem when several different
// population variances are involved", Biometrika 34, 1947). With `b` of many values and `a` without noise it is the test of
// one sample. 1 if the values are equal, 0 if they differ and neither has noise.
double statistics_welch(struct sample_mean a, struct sample_mean b);

// Which of `count` tests have found something, with at most the share `alpha` of them by chance (Benjamini and Hochberg,
// "Controlling the False Discovery Rate", Journal of the Royal Statistical Society B 57(1), 1995). `found` receives it for
// each; returns how many. Without memory: none.
size_t statistics_discoveries(const double *p, size_t count, double alpha, bool *found);

#endif
