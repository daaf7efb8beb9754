// Internal to vct_volume.h: the stages of its making. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_VCT_BUILD_H
#define CANDIL_WORKER_TECHNIQUE_VCT_BUILD_H

#include "server/worker/technique/vct/vct_volume.h"

// The stages; vct_volume.h says in which order.
enum vct_stage { VCT_COMPILE, VCT_VOXELISE, VCT_LIST, VCT_LIGHT, VCT_SHARE, VCT_INJECT, VCT_LEVELS, VCT_GATHER, VCT_DONE };

// Set the grid's parameters and make the pyramid. Of the volume only its voxels and options need be set. STATUS_MEMORY if
// the pyramid does not fit; STATUS_DEVICE.
enum status vct_build_begin(struct vct_volume *volume, const struct plan *plan, struct error *err);

// Do one piece of work of about budget_us. volume->stage is VCT_DONE when nothing is left. Fails as vct_volume_step.
enum status vct_build_piece(struct vct_volume *volume, struct gl_timer *timer, uint32_t budget_us, struct error *err);

// Device memory of the pyramid over a grid, in bytes.
uint64_t vct_pyramid_bytes(const struct voxel_grid *grid, bool isotropic);

#endif
