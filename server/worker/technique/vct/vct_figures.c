#include "server/worker/technique/vct/vct_figures.h"

#include <stdio.h>
#include <stdlib.h>

#include "server/worker/technique/voxel/voxel_occupancy.h"

#define THIN_WORTH_A_NOTE 0.005 // share of the surface from which on a note says so

static void add_axes(struct frame *f, const char *name, const double values[3], const char *unit)
{
	for (int c = 0; c < 3; c++) {
		char full[sizeof f->figures[0].name];
		snprintf(full, sizeof full, "%s.%c", name, "xyz"[c]);
		frame_add_figure(f, full, values[c], unit);
	}
}

static void add_grid(struct frame *f, const struct voxel_grid *grid, const double origin[3])
{
	double sides[3], low[3];
	for (int c = 0; c < 3; c++) {
		sides[c] = grid->sides[c];
		low[c] = origin[c] + (double)grid->low[c];
	}
	add_axes(f, "grid", sides, "cells");
	add_axes(f, "low", low, "m");
	frame_add_figure(f, "voxel", (double)grid->side, "m");
	frame_add_figure(f, "entries", grid->entries, "");
}

static void add_thin(struct frame *f, const struct voxels *voxels)
{
	const double side = (double)voxels->grid.side;
	frame_add_figure(f, "thin", voxels->thin, "");
	if (voxels->thin > THIN_WORTH_A_NOTE)
		frame_add_note(
		    f,
		    "light may leak: %.2g %% of the surface bounds walls thinner than %d voxels (%.3g m), or %d where "
		    "oblique to the grid: a finer vct.resolution or thicker walls hold it",
		    100 * voxels->thin, VCT_THIN_ALIGNED, VCT_THIN_ALIGNED * side, VCT_THIN_OBLIQUE);
}

void vct_figures(struct frame *f, const struct voxels *voxels, const struct vct_volume *v, const double origin[3])
{
	const uint64_t surfaces = voxels_bytes(voxels);
	add_grid(f, &voxels->grid, origin);
	frame_add_figure(f, "bytes.voxels", (double)surfaces, "bytes");
	if (!v) {
		frame_add_figure(f, "bytes.all", (double)surfaces, "bytes");
		return;
	}
	const uint64_t light = v->direct.bytes + v->total.bytes;
	const uint64_t rest = voxels->cells.bytes + v->cells.bytes + v->job.bytes + v->params_block.bytes + v->shares.bytes;
	frame_add_figure(f, "bytes.light", (double)light, "bytes");
	frame_add_figure(f, "bytes.pyramid", (double)v->pyramid.bytes, "bytes");
	frame_add_figure(f, "bytes.all", (double)(surfaces + light + v->pyramid.bytes + rest), "bytes");
	frame_add_figure(f, "levels", v->params.top + 1, "");
	frame_add_figure(f, "cones", v->params.cones, "");
	frame_add_figure(f, "bounces", v->options.bounces, "");
	add_thin(f, voxels);
}

enum status vct_figures_occupied(struct frame *f, const struct voxels *voxels, uint32_t top, struct error *err)
{
	const struct voxel_grid *grid = &voxels->grid;
	const uint64_t bytes = 8ull * voxel_grid_words(grid);
	uint64_t cells[VOXEL_OCCUPANCY_LEVELS];
	uint32_t(*words)[2] = malloc(bytes);
	if (!words)
		return error_set(err, STATUS_MEMORY, "out of memory");
	enum status s = gl_buffer_read(&voxels->words, voxels->device, 0, bytes, words, err);
	if (s == STATUS_OK)
		s = voxel_occupancy(grid, (const uint32_t(*)[2])words, top, cells, err);
	for (uint32_t level = 0; s == STATUS_OK && level <= top; level++) {
		char name[sizeof f->figures[0].name];
		snprintf(name, sizeof name, "occupied.%u", level);
		frame_add_figure(f, name, (double)cells[level] / (double)voxel_occupancy_cells(grid, level), "");
	}
	free(words);
	return s;
}
