// Where the voxels of a scene lie, and how much memory they will take. Host only, any thread; nothing fails.
#ifndef CANDIL_WORKER_TECHNIQUE_VOXEL_GRID_H
#define CANDIL_WORKER_TECHNIQUE_VOXEL_GRID_H

#include <stdbool.h>

#include "server/scene/blob.h"
#include "shaders/shared/voxel.h"

// What a request chooses about a grid. The voxels of a scene are the same with `cube` and without.
struct voxel_options {
	uint32_t resolution; // cells along the longest axis: a power of two, VOXEL_RESOLUTION_MIN … VOXEL_RESOLUTION_MAX
	bool cube; // as many cells along the other axes; else along each the least power of two that holds the scene
};

// Make the grid over a scene's bounds, with `entries` 0. A scene of one point or none gets a grid, too.
void voxel_grid_make(const struct blob_view *scene, const struct voxel_options *options, struct voxel_grid *grid);

// The number of 32-bit words of a grid, without the last one.
uint32_t voxel_grid_words(const struct voxel_grid *grid);

// Device memory of the finished voxels of a grid with so many entries, in bytes: words and entries.
uint64_t voxel_grid_bytes(const struct voxel_grid *grid, uint64_t entries);

// An estimate of the number of entries. A plane of area A passes through at most √3 A / side² voxels, and through 1.5 A /
// side² on average over its directions; borders add some.
uint64_t voxel_entries_guess(const struct blob_view *scene, const struct voxel_grid *grid);

// The largest resolution whose voxels fit `bytes` by that estimate; 0: none does. `entries`: their number with `options`, if
// it is known, else 0.
uint32_t voxel_resolution_that_fits(const struct blob_view *scene, const struct voxel_options *options, uint64_t entries,
				    uint64_t bytes);

#endif
