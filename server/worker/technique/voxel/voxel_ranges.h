// Which triangles of a scene are voxelised: all, those that an edit moved, or those that it left where they were.
#ifndef CANDIL_WORKER_TECHNIQUE_VOXEL_RANGES_H
#define CANDIL_WORKER_TECHNIQUE_VOXEL_RANGES_H

#include <stdbool.h>

#include "server/worker/scenes/resident.h"

struct voxel_range {
	uint32_t first, end; // triangle ids
};

// Ascending, apart from each other, none empty. Zeroed: no triangle.
struct voxel_ranges {
	struct voxel_range *list;
	uint32_t count;
	uint32_t triangles; // of all
};

enum voxel_choice { VOXELS_ALL, VOXELS_MOVED, VOXELS_UNMOVED };

// STATUS_MEMORY leaves nothing.
enum status voxel_ranges_init(struct voxel_ranges *ranges, const struct resident_scene *scene, enum voxel_choice choice,
			      struct error *err);
void voxel_ranges_finish(struct voxel_ranges *ranges); // a zeroed one is fine
bool voxel_ranges_equal(const struct voxel_ranges *a, const struct voxel_ranges *b);

#endif
