// Figures about the voxels of a job of voxel cone tracing, as PROTOCOL.md names them. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_VCT_FIGURES_H
#define CANDIL_WORKER_TECHNIQUE_VCT_FIGURES_H

#include "server/worker/image/frame.h"
#include "server/worker/technique/vct/vct_volume.h"

// Add figures of finished voxels, which lie relative to `origin` (metres, world space), and of the volume over them; NULL:
// there is none.
void vct_figures(struct frame *frame, const struct voxels *voxels, const struct vct_volume *volume, const double origin[3]);

// Add the share of each level's cells that is occupied, up to level `top`. Reads the voxels' bits back from the device, and
// blocks. STATUS_MEMORY, STATUS_DEVICE.
enum status vct_figures_occupied(struct frame *frame, const struct voxels *voxels, uint32_t top, struct error *err);

#endif
