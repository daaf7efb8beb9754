#include "server/worker/technique/voxel/voxel_occupancy.h"

#include <stdlib.h>
#include <string.h>

#include "server/worker/technique/voxel/voxel_grid.h"

#define CELLS_A_WORD 16u

static uint32_t side_of(const struct voxel_grid *grid, int axis, uint32_t level)
{
	const uint32_t side = grid->sides[axis] >> level;
	return side > 0 ? side : 1;
}

uint64_t voxel_occupancy_cells(const struct voxel_grid *grid, uint32_t level)
{
	return (uint64_t)side_of(grid, 0, level) * side_of(grid, 1, level) * side_of(grid, 2, level);
}

// The cell of a level that contains a cell of the level below.
static uint64_t parent(const struct voxel_grid *grid, uint32_t level, uint64_t cell)
{
	const uint64_t wide = side_of(grid, 0, level - 1), high = side_of(grid, 1, level - 1);
	const uint64_t x = cell % wide / 2, y = cell / wide % high / 2, z = cell / wide / high / 2;
	return x + side_of(grid, 0, level) * (y + side_of(grid, 1, level) * z);
}

// Count the occupied voxels, and mark the cells of the first level that contain one.
static uint64_t count_voxels(const struct voxel_grid *grid, const uint32_t (*words)[2], uint8_t *above)
{
	const uint32_t count = voxel_grid_words(grid);
	uint64_t cells = 0;
	for (uint32_t i = 0; i < count; i++) {
		uint64_t cell = (uint64_t)i * CELLS_A_WORD;
		for (uint32_t layers = words[i][0]; layers != 0; layers >>= 2, cell++) {
			if ((layers & 3u) == 0)
				continue;
			above[parent(grid, 1, cell)] = 1;
			cells++;
		}
	}
	return cells;
}

enum status voxel_occupancy(const struct voxel_grid *grid, const uint32_t (*words)[2], uint32_t top,
			    uint64_t cells[VOXEL_OCCUPANCY_LEVELS], struct error *err)
{
	// Each level's marks lie behind those of the level below, of which eight make one.
	const uint64_t room = 2 * voxel_occupancy_cells(grid, 1) + VOXEL_OCCUPANCY_LEVELS;
	uint8_t *marks = calloc(1, room), *level_marks = marks;
	memset(cells, 0, VOXEL_OCCUPANCY_LEVELS * sizeof *cells);
	if (!marks)
		return error_set(err, STATUS_MEMORY, "out of memory");
	cells[0] = count_voxels(grid, words, marks);
	for (uint32_t level = 1; level <= top; level++) {
		const uint64_t count = voxel_occupancy_cells(grid, level);
		uint8_t *next = level_marks + count;
		for (uint64_t i = 0; i < count; i++) {
			cells[level] += level_marks[i];
			if (level_marks[i] && level < top)
				next[parent(grid, level + 1, i)] = 1;
		}
		level_marks = next;
	}
	free(marks);
	return STATUS_OK;
}
