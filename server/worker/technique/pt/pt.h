// The technique `pt`: path tracing in Vulkan compute shaders, the reference for all other techniques.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_H
#define CANDIL_WORKER_TECHNIQUE_PT_H

#include "server/worker/technique/technique.h"

// Its table.
extern const struct technique technique_pt;

#endif
