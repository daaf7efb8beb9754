// The work of voxelising, cut into items of bounded size: the columns of the grid that a triangle passes through, in tiles
// of up to VOXEL_TILE by VOXEL_TILE columns. They are a stream, so the items of a large scene are never all in memory. Host
// only, any thread; nothing fails.
#ifndef CANDIL_WORKER_TECHNIQUE_VOXEL_ITEMS_H
#define CANDIL_WORKER_TECHNIQUE_VOXEL_ITEMS_H

#include "server/worker/technique/voxel/voxel_ranges.h"
#include "shaders/shared/voxel.h"

// A stream: a cursor over triangles and their tiles. What it points to must outlive it.
struct voxel_items {
	const struct vertex *vertices;
	const struct triangle *triangles;
	const struct voxel_ranges *ranges; // of the triangles to voxelise
	struct voxel_grid grid;
	uint32_t range; // of the cursor
	uint32_t triangle; // next, by id
	uint32_t done; // triangles that are behind the cursor
	uint32_t row; // of the triangle's tiles
	uint32_t tile; // in that row
};

// Begin the stream over these triangles of a scene. `ranges` stays the caller's.
void voxel_items_init(struct voxel_items *items, const struct blob_view *scene, const struct voxel_ranges *ranges,
		      const struct voxel_grid *grid);

// Whether all items have been handed out.
static inline bool voxel_items_ended(const struct voxel_items *items)
{
	return items->range == items->ranges->count;
}

// Write up to `capacity` more items to `out`; returns their number, 0 at the end.
uint32_t voxel_items_next(struct voxel_items *items, struct voxel_item *out, uint32_t capacity);

#endif
