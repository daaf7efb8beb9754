// Voxel cone tracing: `direct`'s light, and what other surfaces and the background send by cones through a pyramid of voxels
// (Crassin et al. 2011). No noise; how wrong it is depends on the voxels and the cones, not on samples.
#ifndef CANDIL_WORKER_TECHNIQUE_VCT_H
#define CANDIL_WORKER_TECHNIQUE_VCT_H

#include "server/worker/technique/technique.h"

extern const struct technique technique_vct;

#endif
