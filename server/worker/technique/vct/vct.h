// The technique `vct`, voxel cone tracing: direct light as in `direct`, and indirect light and the background's light by
// cones through a pyramid of voxels (Crassin et al. 2011), or, where it is diffuse, by rays that look up the voxels. Cones
// have no noise: their error depends on the voxels and the cones, not on samples. That of rays falls with their number, down
// to the voxels' own.
#ifndef CANDIL_WORKER_TECHNIQUE_VCT_H
#define CANDIL_WORKER_TECHNIQUE_VCT_H

#include "server/worker/technique/technique.h"

// Its table.
extern const struct technique technique_vct;

#endif
