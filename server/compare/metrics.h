// Figures for the difference of two pictures. Double precision, on linear RGB. One thread for each pair of pictures.
#ifndef CANDIL_COMPARE_METRICS_H
#define CANDIL_COMPARE_METRICS_H

#include <stdbool.h>
#include <stdint.h>

#include "server/compare/picture.h"

#define METRICS_EPSILON 0.01 // in relMSE's denominator: for a reference below 0.1 the error is practically absolute

struct metrics {
	uint32_t width, height; // size at which the pictures were compared
	uint64_t pixels; // number of pixels that the figures cover
	uint64_t masked; // excluded because the reference exceeds the mask's radiance
	uint64_t non_finite_a, non_finite_b; // excluded pixels with a NaN or infinite channel, at the compared size
	double rmse;
	double relmse; // mean of (x − r)² / (r² + METRICS_EPSILON); x is of `a`, r of the reference
	double mean_difference; // mean of x − r
	double max_abs;
	double mean_a, mean_b; // mean over pixels and channels
	double mean_a_rgb[3], mean_b_rgb[3];
};

// Scale the larger picture down with an exact box filter, if each of its sides is the same whole multiple of the other's.
// STATUS_BAD_ARGUMENT if the sizes do not allow it, STATUS_MEMORY.
enum status metrics_fit(struct picture *a, struct picture *b, struct error *err);

// Compare `a` with the reference `b`, of equal size. Pixels of `b` above `mask_above` in any channel are excluded
// (+infinity: none), and so are pixels that are not finite in either picture. The caller's `error` receives a value for
// each pixel (width × height): the root of the pixel's relMSE, −1 if masked, −2 if not finite. STATUS_BAD_ARGUMENT if no
// pixel is left.
enum status metrics_compare(const struct picture *a, const struct picture *b, double mask_above, struct metrics *metrics,
			    float *error, struct error *err);

// Set every pixel that `error` excludes to zero in both pictures, so that a metric over whole pictures ignores it.
void metrics_blank(struct picture *a, struct picture *b, const float *error);

#endif
