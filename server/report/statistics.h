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
#define STATISTICS_BOOTSTRAP_LEAST 8u // values
#define STATISTICS_SHARE 0.95 // of an interval

struct interval {
	double low, high;
};

double statistics_mean(const double *values, size_t count); // NaN of none

// The unbiased variance; NaN of fewer than two.
double statistics_variance(const double *values, size_t count);

// The middle value, of two the mean of both; NaN of none. Sorts `values`.
double statistics_median(double *values, size_t count);

// The 95 % interval of the mean of values that are drawn independently, such as the errors of several seeds. NaN of fewer
// than two values, and without memory; of equal values it has no width. It always holds the values' own mean. The rule:
//
// From STATISTICS_BOOTSTRAP_LEAST values on, the bootstrap of the studentised mean, "bootstrap-t": of STATISTICS_RESAMPLES
// draws with replacement the quantiles of t* = (m* - m) / s*, of which m - t* s is the interval (Efron and Tibshirani, "An
// Introduction to the Bootstrap", 1993, section 12.5). The percentiles of the draws alone are too narrow: of 8 values they
// hold the truth in 80 to 90 % of cases.
//
// Of fewer there is too little to draw from, and a shape must be assumed. Errors and times are positive and skewed to the
// right, so their logarithm is taken for normal: with its mean y and variance v, y + v/2 ± t sqrt(v/n + v²/(2(n - 1))) is
// the interval of the logarithm of the mean, t Student's with n - 1 degrees (Olsson, "Confidence intervals for the mean of a
// log-normal distribution", Journal of Statistics Education 13(1), 2005). Where a value is not above 0 it is Student's
// m ± t s. Of two values t is 12.7: the interval is honest, and hardly of use unless they are close.
struct interval statistics_mean_interval(const double *values, size_t count);

// The same of the median, of whatever is skewed by outliers such as times. From STATISTICS_BOOTSTRAP_LEAST values on the
// percentiles of the bootstrap (section 13.3, ibid.); of fewer Student's interval of the mean of the logarithms, which is
// that of the median if they are distributed evenly about it.
struct interval statistics_median_interval(const double *values, size_t count);

// The t that Student's with `freedom` degrees exceeds, either way, with the probability `p`: the inverse of
// statistics_student, by bisection.
double statistics_student_quantile(double p, double freedom);

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
