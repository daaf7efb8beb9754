// What the files of hemicubes share: hemicube.c, which makes one, hemicube_draw.c, which draws and sums up, and
// hemicube_rows.c, which makes rows of it.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_HEMICUBE_JOB_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_HEMICUBE_JOB_H

#include "server/worker/gl/buffer.h"
#include "server/worker/gl/program.h"
#include "server/worker/gl/texture.h"
#include "server/worker/technique/radiosity/hemicube.h"
#include "shaders/shared/hemicube.h"

// Triangles [first, end), all with masks or all without.
struct hemicube_run {
	uint32_t first, end;
	bool cut;
};

// A pass of cells: what it is drawn into.
struct hemicube_target {
	struct gl_texture ids, depths;
	unsigned framebuffer;
};

// What hemicube.h makes. The scene and the elements are the caller's.
struct hemicube {
	struct gl_device *device;
	struct resident_scene *scene;
	const struct elements *elements;
	struct hemicube_options options;
	uint32_t effects; // of the plan, those of alpha
	uint32_t bindings; // of the scene, for masks
	uint32_t triangle_count;
	uint32_t abreast; // cells in a layer
	uint32_t cells_most; // of a pass
	uint32_t rows_most; // of a batch
	uint32_t list_most; // elements that a row has room for
	uint32_t unit; // of the table: a share of 1 of one hemicube
	float near; // metres
	bool compiled;
	double row_us; // 0: not known
	struct hemicube_run *runs;
	uint32_t run_count;
	unsigned vertex_array;
	struct gl_buffer positions, indices, corners, table, faces, cells, dense, rows, lists, entries, job;
	unsigned corner_texels, table_texels; // texel buffers
	struct hemicube_target target;
	struct gl_program *draw[2]; // of triangles without masks, and with; the second NULL: there are none
	struct gl_program *sum, *pack;
	struct hemicube_cell *host_cells; // of a pass
	struct hemicube_row *host_rows; // of a batch
};

// Draw and sum up cells [0, count) of `host_cells`, which are in the buffer. Commands only.
enum status hemicube_pass(struct hemicube *h, uint32_t count, struct error *err);

// Move what rows [0, count) have met to `entries`, with the first of each told in the buffer of rows. Commands only.
enum status hemicube_pack(const struct hemicube *h, uint32_t count, struct error *err);

#endif
