// Path tracing in a Vulkan compute shader: the reference for everything else.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_H
#define CANDIL_WORKER_TECHNIQUE_PT_H

#include "server/worker/technique/technique.h"

extern const struct technique technique_pt;

// Device memory, in bytes, that a job of this plan takes beside its scene.
uint64_t pt_job_bytes(const struct device *device, const struct plan *plan);

#endif
