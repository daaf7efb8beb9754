// Which triangles of a scene are voxelised: all, those that an edit moved, or those that it left in place. Host only, any
// thread.
#ifndef CANDIL_WORKER_TECHNIQUE_VOXEL_RANGES_H
#define CANDIL_WORKER_TECHNIQUE_VOXEL_RANGES_H

#include <stdbool.h>

#include "server/worker/scenes/resident.h"

// Triangles [first, end), by id.
struct voxel_range {
	uint32_t first, end;
};

// Ranges in ascending order, with gaps between them, none empty. Zeroed: no triangle.
struct voxel_ranges {
	struct voxel_range *list; // owned
	uint32_t count; // of ranges
	uint32_t triangles; // in all of them
};

// Which triangles; of a scene that is no variant none has moved.
enum voxel_choice { VOXELS_ALL, VOXELS_MOVED, VOXELS_UNMOVED };

// Make the ranges of a scene's triangles. STATUS_MEMORY, with nothing left.
enum status voxel_ranges_init(struct voxel_ranges *ranges, const struct resident_scene *scene, enum voxel_choice choice,
			      struct error *err);

// Free them. A zeroed one is fine.
void voxel_ranges_finish(struct voxel_ranges *ranges);

// Whether both have the same triangles.
bool voxel_ranges_equal(const struct voxel_ranges *a, const struct voxel_ranges *b);

#endif
