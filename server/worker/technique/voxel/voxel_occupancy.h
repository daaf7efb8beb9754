// How full a voxel grid is, level by level. No device is needed.
#ifndef CANDIL_WORKER_TECHNIQUE_VOXEL_OCCUPANCY_H
#define CANDIL_WORKER_TECHNIQUE_VOXEL_OCCUPANCY_H

#include "server/base/error.h"
#include "shaders/shared/voxel.h"

#define VOXEL_OCCUPANCY_LEVELS 10u

// Occupied cells of a grid, `words` being voxel_grid_words(grid) pairs of 32 bits as BIND_VOXEL_WORDS has them: cells[0] of
// the voxels themselves, cells[n] of cells twice as large as those of n − 1, up to `top` (below VOXEL_OCCUPANCY_LEVELS).
// STATUS_MEMORY if there is none to count in.
enum status voxel_occupancy(const struct voxel_grid *grid, const uint32_t (*words)[2], uint32_t top,
			    uint64_t cells[VOXEL_OCCUPANCY_LEVELS], struct error *err);

// Cells of a level, occupied or not.
uint64_t voxel_occupancy_cells(const struct voxel_grid *grid, uint32_t level);

#endif
