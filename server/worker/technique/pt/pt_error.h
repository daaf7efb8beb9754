// The path tracer's estimate of its own error, made on the device: a float a tile comes back, not the picture.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_ERROR_H
#define CANDIL_WORKER_TECHNIQUE_PT_ERROR_H

#include <stdint.h>

#include "server/base/error.h"

struct technique_job;

// Samples after which a target error is first looked at: earlier, an estimate is hardly one.
#define PT_ERROR_FIRST 8u

// Make what measuring takes: a pipeline, compiled, a buffer and bindings. pt_error_finish frees it, whatever was made.
enum status pt_error_init(struct technique_job *job, struct error *err);
void pt_error_finish(struct technique_job *job);

// Set job->estimated_relmse to the mean over pixels and channels of ((a − b) / 2)² / (r² + 0.01), a and b being the means of
// the two independent halves of a pixel's samples; shaders/pt/error.comp.glsl says what r is. To -1 before there are two
// samples of every pixel. Not between the dispatches of one batch's tile.
enum status pt_error_measure(struct technique_job *job, struct error *err);

// The least number of samples above `samples` after which a target error is looked at: 8, 12, 16, 24, 32, 48… It depends on
// nothing else, so the same request ends at the same one.
uint32_t pt_error_checkpoint(uint32_t samples);

#endif
