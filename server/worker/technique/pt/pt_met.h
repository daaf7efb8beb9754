// Which pixels of a path traced picture have met a surface so far (shaders/common/met.glsl). Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_MET_H
#define CANDIL_WORKER_TECHNIQUE_PT_MET_H

#include "server/worker/technique/pt/pt_job.h"

// Read their bits: met_bytes (resolve.h) of the picture. The caller frees *met, whatever is returned. Blocks. STATUS_MEMORY,
// STATUS_DEVICE.
enum status pt_met_read(const struct technique_job *job, uint32_t **met, struct error *err);

#endif
