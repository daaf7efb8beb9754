// The difference of two pictures in figures. Plain arithmetic in double precision on linear RGB.
#ifndef CANDIL_COMPARE_METRICS_H
#define CANDIL_COMPARE_METRICS_H

#include <stdbool.h>
#include <stdint.h>

#include "server/compare/picture.h"

#define METRICS_EPSILON 0.01 // in relMSE's denominator: below a radiance of 0.1 the error counts as absolute

struct metrics {
	uint32_t width, height; // compared at
	uint64_t pixels; // that the figures are of
	uint64_t masked; // left out: the reference exceeds the mask's radiance
	uint64_t non_finite_a, non_finite_b; // pixels with a NaN or infinite channel, at the compared size; left out too
	double rmse;
	double relmse; // mean of (x − r)² / (r² + METRICS_EPSILON)
	double mean_difference; // of x − r
	double max_abs;
	double mean_a, mean_b; // over pixels and channels
	double mean_a_rgb[3], mean_b_rgb[3];
};

// Scale the larger of the two down by an exact box filter where each of its sides is the same whole multiple of the other's.
// STATUS_BAD_ARGUMENT if the sizes do not fit so, STATUS_MEMORY.
enum status metrics_fit(struct picture *a, struct picture *b, struct error *err);

// Compare `a` with the reference `b`, of equal size. Pixels of `b` above `mask_above` in any channel are left out
// (+infinity: none), as are pixels that are not finite in either. `error` gets a value a pixel (width × height): the root of
// the pixel's relMSE, −1 where masked, −2 where not finite. STATUS_BAD_ARGUMENT if no pixel is left.
enum status metrics_compare(const struct picture *a, const struct picture *b, double mask_above, struct metrics *metrics,
			    float *error, struct error *err);

// Zero every pixel of both that `error` leaves out, so that a metric over whole pictures does not see them.
void metrics_blank(struct picture *a, struct picture *b, const float *error);

#endif
