// The path tracer's estimate of its own error, computed on the device: a few sums for each tile are read back, not the
// picture. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_ERROR_H
#define CANDIL_WORKER_TECHNIQUE_PT_ERROR_H

#include <stdint.h>

#include "server/base/error.h"

struct technique_job;

// Make what measuring needs: a compiled pipeline, a buffer and bindings. STATUS_MEMORY, STATUS_DEVICE; pt_error_finish frees
// what was made by then.
enum status pt_error_init(struct technique_job *job, struct error *err);

// Free it.
void pt_error_finish(struct technique_job *job);

// Set job->estimate to that of the picture so far: server/worker/technique/pt/pt_relmse.h. It is unknown while pixels have
// fewer than two samples. A picture without light has no error if nothing of its scene gives light or no pixel shows a
// surface, and is unknown else. Not to be called between the dispatches of a tile of one batch. Blocks. STATUS_MEMORY,
// STATUS_DEVICE.
enum status pt_error_measure(struct technique_job *job, struct error *err);

#endif
