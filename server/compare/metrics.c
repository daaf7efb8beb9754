#include "server/compare/metrics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// The factor by which `large` exceeds `small` on both sides; 0 if there is no such whole number.
static uint32_t factor_of(const struct picture *large, const struct picture *small)
{
	uint32_t factor = large->width / small->width;
	bool fits =
	    factor >= 1 && large->width == factor * small->width && large->height == (uint64_t)factor * small->height;
	return fits ? factor : 0;
}

static double box_mean(const struct picture *p, uint32_t x, uint32_t y, uint32_t factor, uint32_t channel)
{
	double sum = 0;
	for (uint32_t j = 0; j < factor; j++)
		for (uint32_t i = 0; i < factor; i++) {
			size_t pixel = ((size_t)y * factor + j) * p->width + (size_t)x * factor + i;
			sum += (double)p->rgb[3 * pixel + channel];
		}
	return sum / ((double)factor * factor);
}

static enum status scale_down(struct picture *p, uint32_t factor, struct error *err)
{
	struct picture small = {.width = p->width / factor, .height = p->height / factor};
	small.rgb = malloc((size_t)small.width * small.height * 3 * sizeof *small.rgb);
	if (!small.rgb)
		return error_set(err, STATUS_MEMORY, "no memory to scale a picture down");
	float *to = small.rgb;
	for (uint32_t y = 0; y < small.height; y++)
		for (uint32_t x = 0; x < small.width; x++)
			for (uint32_t c = 0; c < 3; c++)
				*to++ = (float)box_mean(p, x, y, factor, c);
	picture_finish(p);
	*p = small;
	return STATUS_OK;
}

enum status metrics_fit(struct picture *a, struct picture *b, struct error *err)
{
	uint32_t down_a = factor_of(a, b), down_b = factor_of(b, a);
	if (down_a == 1)
		return STATUS_OK;
	if (down_a)
		return scale_down(a, down_a, err);
	if (down_b)
		return scale_down(b, down_b, err);
	return error_set(err, STATUS_BAD_ARGUMENT,
			 "%u x %u and %u x %u cannot be compared; one size must be a whole multiple of the other", a->width,
			 a->height, b->width, b->height);
}

static bool finite3(const float *v)
{
	return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

static bool above(const float *v, double limit)
{
	return (double)v[0] > limit || (double)v[1] > limit || (double)v[2] > limit;
}

struct sums {
	double squares, relative, difference;
	double a[3], b[3];
};

// Add a pixel to the sums. Returns its share of the relMSE.
static double add_pixel(const float *x, const float *r, struct sums *sums, double *max_abs)
{
	double relative = 0;
	for (int c = 0; c < 3; c++) {
		double reference = (double)r[c], d = (double)x[c] - reference;
		sums->squares += d * d;
		relative += d * d / (reference * reference + METRICS_EPSILON);
		sums->difference += d;
		sums->a[c] += (double)x[c];
		sums->b[c] += reference;
		*max_abs = fmax(*max_abs, fabs(d));
	}
	sums->relative += relative;
	return relative / 3;
}

enum status metrics_compare(const struct picture *a, const struct picture *b, double mask_above, struct metrics *metrics,
			    float *error, struct error *err)
{
	struct sums sums = {0};
	memset(metrics, 0, sizeof *metrics);
	metrics->width = b->width;
	metrics->height = b->height;
	size_t count = (size_t)b->width * b->height;
	for (size_t i = 0; i < count; i++) {
		const float *x = a->rgb + 3 * i, *r = b->rgb + 3 * i;
		bool good_a = finite3(x), good_b = finite3(r), masked = above(r, mask_above);
		error[i] = masked ? -1.0f : -2.0f;
		metrics->masked += masked;
		metrics->non_finite_a += !good_a;
		metrics->non_finite_b += !good_b;
		if (masked || !good_a || !good_b)
			continue;
		metrics->pixels++;
		error[i] = (float)sqrt(add_pixel(x, r, &sums, &metrics->max_abs));
	}
	if (metrics->pixels == 0)
		return error_set(err, STATUS_BAD_ARGUMENT, "no pixel is left to compare: all are masked or not finite");
	double n = (double)metrics->pixels;
	metrics->rmse = sqrt(sums.squares / (3 * n));
	metrics->relmse = sums.relative / (3 * n);
	metrics->mean_difference = sums.difference / (3 * n);
	for (int c = 0; c < 3; c++) {
		metrics->mean_a_rgb[c] = sums.a[c] / n;
		metrics->mean_b_rgb[c] = sums.b[c] / n;
		metrics->mean_a += metrics->mean_a_rgb[c] / 3;
		metrics->mean_b += metrics->mean_b_rgb[c] / 3;
	}
	return STATUS_OK;
}

void metrics_blank(struct picture *a, struct picture *b, const float *error)
{
	size_t count = (size_t)a->width * a->height;
	for (size_t i = 0; i < count; i++)
		if (error[i] < 0) {
			memset(a->rgb + 3 * i, 0, 3 * sizeof *a->rgb);
			memset(b->rgb + 3 * i, 0, 3 * sizeof *b->rgb);
		}
}
