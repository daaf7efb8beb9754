// From sums to a picture: the path tracer's accumulator divided by its sample counts, and the error that its two halves tell.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_RESOLVE_H
#define CANDIL_WORKER_TECHNIQUE_PT_RESOLVE_H

#include <stdint.h>

#include "server/worker/image/frame.h"

// How far a job has come: every pixel has `samples`, those of the first `tiles` tiles one more.
struct pt_progress {
	uint32_t first_sample;
	uint32_t samples;
	uint32_t tiles;
};

// Fill frame->radiance and frame->estimated_relmse from ACCUMULATOR_FLOATS floats a pixel (shaders/path/accumulate.glsl).
//
// The estimate: with a and b the means of the two independent halves, ((a − b) / 2)² is an unbiased estimate of the variance
// of (a + b) / 2, and relMSE is its mean over r² + 0.01 with r the pixel's own value. Negative where a half has no sample.
void pt_resolve(const float *sums, const struct pt_progress *progress, struct frame *frame);

#endif
