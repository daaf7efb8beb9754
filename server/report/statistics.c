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

struct interval statistics_bootstrap(statistics_figure figure, const void *context, size_t count)
{
	struct interval interval = {(double)NAN, (double)NAN};
	double *drawn = calloc(STATISTICS_RESAMPLES, sizeof *drawn);
	size_t *pick = calloc(count ? count : 1, sizeof *pick);
	uint64_t state = STATISTICS_SEED;
	if (drawn && pick && count > 1) {
		for (size_t k = 0; k < STATISTICS_RESAMPLES; k++) {
			for (size_t i = 0; i < count; i++)
				pick[i] = (size_t)((double)(next(&state) >> 11) * 0x1p-53 * (double)count);
			drawn[k] = figure(context, pick, count);
		}
		qsort(drawn, STATISTICS_RESAMPLES, sizeof *drawn, ascending);
		interval.low = quantile(drawn, STATISTICS_RESAMPLES, (1 - STATISTICS_SHARE) / 2);
		interval.high = quantile(drawn, STATISTICS_RESAMPLES, (1 + STATISTICS_SHARE) / 2);
	}
	free(drawn);
	free(pick);
	return interval;
}

static double mean_of_picked(const void *context, const size_t *pick, size_t count)
{
	const double *values = context;
	double sum = 0;
	for (size_t i = 0; i < count; i++)
		sum += values[pick[i]];
	return sum / (double)count;
}

static double median_of_picked(const void *context, const size_t *pick, size_t count)
{
	const double *values = context;
	double *picked = calloc(count, sizeof *picked);
	if (!picked)
		return (double)NAN;
	for (size_t i = 0; i < count; i++)
		picked[i] = values[pick[i]];
	const double median = statistics_median(picked, count);
	free(picked);
	return median;
}

struct interval statistics_bootstrap_mean(const double *values, size_t count)
{
	return statistics_bootstrap(mean_of_picked, values, count);
}

struct interval statistics_bootstrap_median(const double *values, size_t count)
{
	return statistics_bootstrap(median_of_picked, values, count);
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
