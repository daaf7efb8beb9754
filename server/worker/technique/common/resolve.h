// From sums to a picture: the accumulators of a technique divided by their sample counts, and the error that their two
// halves tell.
#ifndef CANDIL_WORKER_TECHNIQUE_RESOLVE_H
#define CANDIL_WORKER_TECHNIQUE_RESOLVE_H

#include <stdint.h>

#include "server/worker/image/frame.h"

struct resolver {
	uint32_t tiles; // the image's first tiles, which have more samples
	double counts[2][2]; // samples of half A and B: in the other tiles, in those first ones
	double error; // so far
	uint64_t known;
	const uint32_t *film; // of the rows to come, struct film_pixel a pixel; NULL: there is none
	double film_units[2]; // what one of its numbers is in half A and B, W/(m² sr)
};

// Every pixel has `samples` from `first_sample` on, those of the first `tiles` tiles `more` on top.
void resolver_init(struct resolver *resolver, uint32_t first_sample, uint32_t samples, uint32_t tiles, uint32_t more);

// Fill rows [first_row, first_row + rows) of frame->radiance from their sums, ACCUMULATOR_FLOATS floats a pixel
// (shaders/common/accumulate.glsl).
void resolve_sums(struct resolver *resolver, const float *sums, uint32_t first_row, uint32_t rows, struct frame *frame);

// Fill the same rows of the AOVs that the frame has, from AOV_WORDS words a pixel.
void resolve_aovs(const uint32_t *words, uint32_t first_row, uint32_t rows, struct frame *frame);

// The estimated relMSE of what was resolved: with a and b the means of the two independent halves, ((a − b) / 2)² is an
// unbiased estimate of the variance of (a + b) / 2; relMSE is its mean over r² + 0.01, r being the pixel's own value.
// Negative where a half has no sample.
double resolver_error(const struct resolver *resolver);

#endif
