// Inside vct_volume: the stages of its making.
#ifndef CANDIL_WORKER_TECHNIQUE_VCT_BUILD_H
#define CANDIL_WORKER_TECHNIQUE_VCT_BUILD_H

#include "server/worker/technique/vct/vct_volume.h"

enum vct_stage { VCT_COMPILE, VCT_VOXELISE, VCT_LIST, VCT_LIGHT, VCT_SHARE, VCT_INJECT, VCT_LEVELS, VCT_GATHER, VCT_DONE };

// The grid's parameters, and the pyramid made: needs voxel options alone. STATUS_MEMORY if it does not fit.
enum status vct_build_begin(struct vct_volume *volume, const struct plan *plan, struct error *err);

// One piece of work of about budget_us. stage is VCT_DONE when nothing is left.
enum status vct_build_piece(struct vct_volume *volume, struct gl_timer *timer, uint32_t budget_us, struct error *err);

// Bytes of the pyramid over a grid.
uint64_t vct_pyramid_bytes(const struct voxel_grid *grid, bool isotropic);

#endif
