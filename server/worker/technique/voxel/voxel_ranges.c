#include "server/worker/technique/voxel/voxel_ranges.h"

#include <stdlib.h>
#include <string.h>

static int by_first(const void *a, const void *b)
{
	const uint32_t x = ((const struct voxel_range *)a)->first, y = ((const struct voxel_range *)b)->first;
	return x < y ? -1 : x > y;
}

// Write the moves' triangles to `list`, sorted and merged; it has room for them. Returns the number of ranges.
static uint32_t moved_ranges(const struct resident_scene *scene, struct voxel_range *list)
{
	const struct edited *e = &scene->edited;
	uint32_t n = 0, count = 0;
	for (uint32_t i = 0; i < e->move_count; i++)
		if (e->moves[i].triangle_count > 0)
			list[n++] = (struct voxel_range){e->moves[i].first_triangle,
							 e->moves[i].first_triangle + e->moves[i].triangle_count};
	qsort(list, n, sizeof *list, by_first);
	for (uint32_t i = 0; i < n; i++) {
		if (count > 0 && list[i].first <= list[count - 1].end)
			list[count - 1].end = list[i].end > list[count - 1].end ? list[i].end : list[count - 1].end;
		else
			list[count++] = list[i];
	}
	return count;
}

// Replace `count` ranges by those between them, before them, and behind them up to `end`: one more at most.
static uint32_t between(struct voxel_range *list, uint32_t count, uint32_t end)
{
	uint32_t n = 0, at = 0;
	for (uint32_t i = 0; i < count; i++) {
		const struct voxel_range r = list[i];
		if (at < r.first)
			list[n++] = (struct voxel_range){at, r.first};
		at = r.end;
	}
	if (at < end)
		list[n++] = (struct voxel_range){at, end};
	return n;
}

enum status voxel_ranges_init(struct voxel_ranges *r, const struct resident_scene *scene, enum voxel_choice choice,
			      struct error *err)
{
	*r = (struct voxel_ranges){.list = calloc(scene->edited.move_count + 1u, sizeof *r->list)};
	if (!r->list)
		return error_set(err, STATUS_MEMORY, "out of memory");
	r->count = choice == VOXELS_ALL ? 0 : moved_ranges(scene, r->list);
	if (choice != VOXELS_MOVED)
		r->count = between(r->list, r->count, scene_count(scene, BLOB_TRIANGLES));
	for (uint32_t i = 0; i < r->count; i++)
		r->triangles += r->list[i].end - r->list[i].first;
	return STATUS_OK;
}

void voxel_ranges_finish(struct voxel_ranges *r)
{
	free(r->list);
	*r = (struct voxel_ranges){0};
}

bool voxel_ranges_equal(const struct voxel_ranges *a, const struct voxel_ranges *b)
{
	return a->count == b->count && (a->count == 0 || !memcmp(a->list, b->list, a->count * sizeof *a->list));
}
