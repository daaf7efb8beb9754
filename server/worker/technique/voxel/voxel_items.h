// The work of voxelising, cut into pieces of bounded size: each triangle's columns over the grid in tiles of up to
// VOXEL_TILE by VOXEL_TILE, those that it passes through. A stream, for all the tiles of a large scene need not be in memory
// at once.
#ifndef CANDIL_WORKER_TECHNIQUE_VOXEL_ITEMS_H
#define CANDIL_WORKER_TECHNIQUE_VOXEL_ITEMS_H

#include "server/worker/technique/voxel/voxel_ranges.h"
#include "shaders/shared/voxel.h"

struct voxel_items {
	const struct vertex *vertices;
	const struct triangle *triangles;
	const struct voxel_ranges *ranges; // which of them
	struct voxel_grid grid;
	uint32_t range; // where the cursor is
	uint32_t triangle; // next
	uint32_t done; // triangles behind it
	uint32_t row; // of its tiles
	uint32_t tile; // of that row's
};

// Over these triangles of the scene; `ranges` stays the caller's.
void voxel_items_init(struct voxel_items *items, const struct blob_view *scene, const struct voxel_ranges *ranges,
		      const struct voxel_grid *grid);

static inline bool voxel_items_ended(const struct voxel_items *items)
{
	return items->range == items->ranges->count;
}

// Up to `capacity` items more; returns their number, 0 at the end.
uint32_t voxel_items_next(struct voxel_items *items, struct voxel_item *out, uint32_t capacity);

#endif
