// Where the voxels of a scene lie, and what they take before they are made. No device is needed.
#ifndef CANDIL_WORKER_TECHNIQUE_VOXEL_GRID_H
#define CANDIL_WORKER_TECHNIQUE_VOXEL_GRID_H

#include <stdbool.h>

#include "server/scene/blob.h"
#include "shaders/shared/voxel.h"

struct voxel_options {
	uint32_t resolution; // a power of two, VOXEL_RESOLUTION_MIN … VOXEL_RESOLUTION_MAX: cells along the longest axis
	bool cube; // as many along the others; else each its own power of two, as few as hold the scene: the same voxels
};

// The grid over a scene's bounds; entries is 0. A scene of one point or none gets some grid, too.
void voxel_grid_make(const struct blob_view *scene, const struct voxel_options *options, struct voxel_grid *grid);

// Words of 32 bits of a grid, without the last one.
uint32_t voxel_grid_words(const struct voxel_grid *grid);

// Device memory of a grid with so many entries, when it is done: words and entries.
uint64_t voxel_grid_bytes(const struct voxel_grid *grid, uint64_t entries);

// About how many entries there will be: a plane of area A passes through at most √3 A / side² voxels and 1.5 A / side² on
// average over its directions, and borders add some.
uint64_t voxel_entries_guess(const struct blob_view *scene, const struct voxel_grid *grid);

// The largest resolution whose voxels fit `bytes` by that guess; `entries` (> 0) at `options` is known, or 0. 0: none fits.
uint32_t voxel_resolution_that_fits(const struct blob_view *scene, const struct voxel_options *options, uint64_t entries,
				    uint64_t bytes);

#endif
