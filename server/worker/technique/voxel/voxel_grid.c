#include "server/worker/technique/voxel/voxel_grid.h"

#include <math.h>
#include <string.h>

// The least side of a voxel: below it, two places of the scene may be the same float.
static double least_extent(const struct blob_view *scene)
{
	double far = 1e-20;
	for (int c = 0; c < 3; c++)
		far = fmax(far, fmax(fabs((double)scene->bounds_min[c]), fabs((double)scene->bounds_max[c])));
	return far * 1e-6;
}

static uint32_t power_of_two_from(uint32_t n)
{
	uint32_t p = 4;
	while (p < n)
		p *= 2;
	return p;
}

void voxel_grid_make(const struct blob_view *scene, const struct voxel_options *o, struct voxel_grid *grid)
{
	const bool empty = scene->counts[BLOB_TRIANGLES] == 0;
	double extents[3], longest = empty ? 1 : least_extent(scene);
	for (int c = 0; c < 3; c++) {
		extents[c] = empty ? 0 : (double)scene->bounds_max[c] - (double)scene->bounds_min[c];
		longest = fmax(longest, extents[c]);
	}
	memset(grid, 0, sizeof *grid);
	grid->side = (float)(longest / (o->resolution - VOXEL_MARGIN));
	const double side = (double)grid->side;
	for (int c = 0; c < 3; c++) {
		const double low = empty ? 0 : (double)scene->bounds_min[c];
		const uint32_t need = (uint32_t)(VOXEL_FIRST + extents[c] / side) + 2;
		const uint32_t fitted = power_of_two_from(need);
		grid->low[c] = (float)(low - VOXEL_FIRST * side);
		grid->sides[c] = o->cube || fitted > o->resolution ? o->resolution : fitted;
	}
}

uint32_t voxel_grid_words(const struct voxel_grid *g)
{
	return g->sides[0] * g->sides[1] * g->sides[2] / 16;
}

uint64_t voxel_grid_bytes(const struct voxel_grid *g, uint64_t entries)
{
	return 8ull * (voxel_grid_words(g) + 1ull) + sizeof *g + VOXEL_PARTS * 16 * entries;
}

static double area_of(const struct vertex *vertices, const struct triangle *t)
{
	double e[2][3];
	for (int k = 0; k < 2; k++)
		for (int c = 0; c < 3; c++)
			e[k][c] =
			    (double)vertices[t->vertex[k + 1]].position[c] - (double)vertices[t->vertex[0]].position[c];
	const double x = e[0][1] * e[1][2] - e[0][2] * e[1][1], y = e[0][2] * e[1][0] - e[0][0] * e[1][2],
		     z = e[0][0] * e[1][1] - e[0][1] * e[1][0];
	return 0.5 * sqrt(x * x + y * y + z * z);
}

uint64_t voxel_entries_guess(const struct blob_view *scene, const struct voxel_grid *g)
{
	const struct triangle *triangles = scene->sections[BLOB_TRIANGLES];
	double area = 0;
	for (uint32_t i = 0; i < scene->counts[BLOB_TRIANGLES]; i++)
		area += area_of(scene->sections[BLOB_VERTICES], &triangles[i]);
	const double side = (double)g->side, entries = 1.5 * area / (side * side);
	const double most = 2.0 * g->sides[0] * g->sides[1] * g->sides[2];
	return (uint64_t)(entries < most ? entries : most);
}

uint32_t voxel_resolution_that_fits(const struct blob_view *scene, const struct voxel_options *options, uint64_t entries,
				    uint64_t bytes)
{
	struct voxel_options o = *options;
	struct voxel_grid grid;
	if (entries == 0) {
		voxel_grid_make(scene, &o, &grid);
		entries = voxel_entries_guess(scene, &grid);
	}
	while (o.resolution > VOXEL_RESOLUTION_MIN) {
		o.resolution /= 2;
		entries = entries / 4 + 1;
		voxel_grid_make(scene, &o, &grid);
		if (voxel_grid_bytes(&grid, entries + entries / 4) <= bytes)
			return o.resolution;
	}
	return 0;
}
