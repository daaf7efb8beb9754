// How full a voxel grid is, level by level. Host only, any thread.
#ifndef CANDIL_WORKER_TECHNIQUE_VOXEL_OCCUPANCY_H
#define CANDIL_WORKER_TECHNIQUE_VOXEL_OCCUPANCY_H

#include "server/base/error.h"
#include "shaders/shared/voxel.h"

#define VOXEL_OCCUPANCY_LEVELS 10u // levels at most

// Count the occupied cells of a grid: cells[0] are the voxels themselves, cells[n] cells twice as large as those of n − 1,
// up to cells[top] (below VOXEL_OCCUPANCY_LEVELS). `words` are voxel_grid_words(grid) pairs of 32 bits, as at
// BIND_VOXEL_WORDS. STATUS_MEMORY.
enum status voxel_occupancy(const struct voxel_grid *grid, const uint32_t (*words)[2], uint32_t top,
			    uint64_t cells[VOXEL_OCCUPANCY_LEVELS], struct error *err);

// The number of cells of a level, occupied or not.
uint64_t voxel_occupancy_cells(const struct voxel_grid *grid, uint32_t level);

#endif
