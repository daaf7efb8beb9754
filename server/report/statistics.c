#include "server/report/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

double statistics_mean(const double *values, size_t count)
{
	double sum = 0;
	for (size_t i = 0; i < count; i++)
		sum += values[i];
	return count ? sum / (double)count : (double)NAN;
}

double statistics_variance(const double *values, size_t count)
{
	const double mean = statistics_mean(values, count);
	double sum = 0;
	for (size_t i = 0; i < count; i++)
		sum += (values[i] - mean) * (values[i] - mean);
	return count > 1 ? sum / (double)(count - 1) : (double)NAN;
}

static int ascending(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

double statistics_median(double *values, size_t count)
{
	if (count == 0)
		return (double)NAN;
	qsort(values, count, sizeof *values, ascending);
	return count % 2 ? values[count / 2] : (values[count / 2 - 1] + values[count / 2]) / 2;
}

// SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014).
static uint64_t next(uint64_t *state)
{
	uint64_t z = *state += 0x9e3779b97f4a7c15u;
	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return z ^ (z >> 31);
}

// The value below which the share `q` of sorted values lies, between two of them in proportion.
static double quantile(const double *sorted, size_t count, double q)
{
	const double at = q * (double)(count - 1), whole = floor(at);
	const size_t i = (size_t)whole;
	return i + 1 < count ? sorted[i] + (at - whole) * (sorted[i + 1] - sorted[i]) : sorted[i];
}

// A figure of drawn values, which it may sort; `mean` is that of the values they were drawn from.
typedef double (*drawn_figure)(double *values, size_t count, double mean);

static double median_of(double *values, size_t count, double mean)
{
	(void)mean;
	return statistics_median(values, count);
}

static double standard_error(const double *values, size_t count)
{
	return sqrt(statistics_variance(values, count) / (double)count);
}

static double studentised(double *values, size_t count, double mean)
{
	const double difference = statistics_mean(values, count) - mean, error = standard_error(values, count);
	return difference == 0 ? 0 : difference / error; // equal values that were drawn lie infinitely far
}

// The quantiles of a figure of draws with replacement: the middle STATISTICS_SHARE of it.
static struct interval resample(drawn_figure figure, const double *values, size_t count)
{
	struct interval interval = {(double)NAN, (double)NAN};
	double *drawn = calloc(STATISTICS_RESAMPLES, sizeof *drawn), *picked = calloc(count, sizeof *picked);
	const double mean = statistics_mean(values, count);
	uint64_t state = STATISTICS_SEED;
	if (drawn && picked) {
		for (size_t k = 0; k < STATISTICS_RESAMPLES; k++) {
			for (size_t i = 0; i < count; i++)
				picked[i] = values[(size_t)((double)(next(&state) >> 11) * 0x1p-53 * (double)count)];
			drawn[k] = figure(picked, count, mean);
		}
		qsort(drawn, STATISTICS_RESAMPLES, sizeof *drawn, ascending);
		interval.low = quantile(drawn, STATISTICS_RESAMPLES, (1 - STATISTICS_SHARE) / 2);
		interval.high = quantile(drawn, STATISTICS_RESAMPLES, (1 + STATISTICS_SHARE) / 2);
	}
	free(drawn);
	free(picked);
	return interval;
}

// Student's interval of the mean of the logarithms, as values again; `of_mean`: with what makes it that of the mean of the
// values. Where there is no logarithm it is that of the values themselves.
static struct interval student_interval(const double *values, size_t count, bool of_mean)
{
	const double n = (double)count, t = statistics_student_quantile(1 - STATISTICS_SHARE, n - 1);
	double sum = 0, squares = 0;
	for (size_t i = 0; i < count; i++) {
		if (!(values[i] > 0)) {
			const double mean = statistics_mean(values, count), half = t * standard_error(values, count);
			return (struct interval){mean - half, mean + half};
		}
		sum += log(values[i]);
	}
	for (size_t i = 0; i < count; i++)
		squares += (log(values[i]) - sum / n) * (log(values[i]) - sum / n);
	const double v = squares / (n - 1), middle = sum / n + (of_mean ? v / 2 : 0);
	const double half = t * sqrt(v / n + (of_mean ? v * v / (2 * (n - 1)) : 0));
	return (struct interval){exp(middle - half), exp(middle + half)};
}

// Equal values have an interval without width, whatever their logarithms are rounded to.
static bool all_equal(const double *values, size_t count)
{
	for (size_t i = 1; i < count; i++)
		if (values[i] != values[0])
			return false;
	return true;
}

struct interval statistics_mean_interval(const double *values, size_t count)
{
	struct interval interval = {(double)NAN, (double)NAN};
	if (count < 2)
		return interval;
	if (all_equal(values, count))
		return (struct interval){values[0], values[0]};
	const double mean = statistics_mean(values, count);
	if (count < STATISTICS_BOOTSTRAP_LEAST) {
		interval = student_interval(values, count, true);
	} else {
		const struct interval t = resample(studentised, values, count);
		const double error = standard_error(values, count);
		interval = (struct interval){mean - t.high * error, mean - t.low * error};
	}
	if (isnan(interval.low) || isnan(interval.high))
		return interval;
	return (struct interval){fmin(interval.low, mean), fmax(interval.high, mean)};
}

struct interval statistics_median_interval(const double *values, size_t count)
{
	if (count < 2)
		return (struct interval){(double)NAN, (double)NAN};
	if (all_equal(values, count))
		return (struct interval){values[0], values[0]};
	return count < STATISTICS_BOOTSTRAP_LEAST ? student_interval(values, count, false)
						  : resample(median_of, values, count);
}

// The continued fraction of the incomplete beta function (NIST DLMF 8.17.22), by Lentz's method (Press et al., "Numerical
// Recipes", section 6.4).
static double beta_fraction(double a, double b, double x)
{
	const double least = 1e-300;
	double c = 1, d = 1 - (a + b) * x / (a + 1);
	d = 1 / (fabs(d) < least ? least : d);
	double h = d;
	for (int m = 1; m < 500; m++) {
		const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
		const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
		const double terms[2] = {even, odd};
		double step = 1;
		for (int k = 0; k < 2; k++) {
			d = 1 + terms[k] * d;
			d = 1 / (fabs(d) < least ? least : d);
			c = 1 + terms[k] / c;
			c = fabs(c) < least ? least : c;
			step = c * d;
			h *= step;
		}
		if (fabs(step - 1) < 1e-14)
			break;
	}
	return h;
}

static double incomplete_beta(double a, double b, double x)
{
	if (!(x > 0))
		return 0;
	if (x >= 1)
		return 1;
	const double front = exp(lgamma(a + b) - lgamma(a) - lgamma(b) + a * log(x) + b * log1p(-x));
	if (x < (a + 1) / (a + b + 2))
		return front * beta_fraction(a, b, x) / a;
	return 1 - front * beta_fraction(b, a, 1 - x) / b;
}

double statistics_student(double t, double freedom)
{
	return incomplete_beta(freedom / 2, 0.5, freedom / (freedom + t * t));
}

double statistics_student_quantile(double p, double freedom)
{
	double low = 0, high = 1;
	while (statistics_student(high, freedom) > p && high < 1e12)
		high *= 2;
	for (int i = 0; i < 80; i++) {
		const double middle = (low + high) / 2;
		if (statistics_student(middle, freedom) > p)
			low = middle;
		else
			high = middle;
	}
	return (low + high) / 2;
}

double statistics_welch(struct sample_mean a, struct sample_mean b)
{
	const double difference = a.value - b.value, variance = a.variance + b.variance;
	if (difference == 0)
		return 1;
	if (!(variance > 0))
		return 0;
	const double of_a = a.variance > 0 ? a.variance * a.variance / a.freedom : 0;
	const double of_b = b.variance > 0 ? b.variance * b.variance / b.freedom : 0;
	return statistics_student(difference / sqrt(variance), variance * variance / (of_a + of_b));
}

size_t statistics_discoveries(const double *p, size_t count, double alpha, bool *found)
{
	double *sorted = calloc(count ? count : 1, sizeof *sorted), most = -1;
	size_t discoveries = 0;
	memset(found, 0, count * sizeof *found);
	if (!sorted)
		return 0;
	memcpy(sorted, p, count * sizeof *p);
	qsort(sorted, count, sizeof *sorted, ascending);
	for (size_t i = 0; i < count; i++)
		if (sorted[i] <= alpha * (double)(i + 1) / (double)count)
			most = sorted[i];
	for (size_t i = 0; i < count; i++) {
		found[i] = p[i] <= most;
		discoveries += found[i];
	}
	free(sorted);
	return discoveries;
}
