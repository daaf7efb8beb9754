// Path tracing in a Vulkan compute shader: the reference for everything else.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_H
#define CANDIL_WORKER_TECHNIQUE_PT_H

#include "server/worker/technique/technique.h"

extern const struct technique technique_pt;

#endif
