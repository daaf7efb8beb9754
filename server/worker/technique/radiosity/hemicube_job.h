// What the files of hemicubes share: hemicube.c and hemicube_upload.c,
// which make one, hemicube_draw.c, which draws and sums up, hemicube_portal.c,
// which looks into mirrors, and hemicube_rows.c, which makes rows of all that.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_HEMICUBE_JOB_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_HEMICUBE_JOB_H

#include "server/worker/gl/buffer.h"
#include "server/worker/gl/program.h"
#include "server/worker/gl/texture.h"
#include "server/worker/technique/radiosity/hemicube.h"
#include "server/worker/technique/radiosity/hemicube_clusters.h"
#include "server/worker/technique/radiosity/hemicube_planes.h"
#include "shaders/shared/hemicube.h"

#define HEMICUBE_ALL_FACES 31u // bits
#define HEMICUBE_PARTS 3u // of a layer: all of it, its lower and its upper half
#define HEMICUBE_LISTS (2 * HEMICUBE_PARTS) // of draws: of clusters without masks by parts, then of those with
#define HEMICUBE_CELLS_MOST 256u // of a pass
#define HEMICUBE_LISTED_MOST (1u << 20) // corners that are drawn without a stop
#define HEMICUBE_UNIT 0xFFFFFFF8u // of sums: so much is a share of 1 of one hemicube

// A draw of what a face sees, as OpenGL reads it.
struct hemicube_draw {
	uint32_t corners, instances;
	uint32_t first; // of `listed`
	uint32_t first_vertex; // 0
	uint32_t first_instance; // cell · 8 + face
};

// Draws that are made at once.
struct hemicube_list {
	struct hemicube_draw draws[2 * HEMICUBE_CELLS_MOST]; // a part has two faces of a cell at most
	uint32_t count;
};

// What a pass of cells is drawn into.
struct hemicube_target {
	struct gl_texture ids, depths;
	unsigned framebuffer;
};

// A cell, as the host has it.
struct hemicube_view {
	struct hemicube_origin origin;
	uint32_t row; // of the batch
	uint32_t parent, plane; // as in struct hemicube_cell
	uint32_t faces; // bits of the faces that are to be drawn
};

// The cells that see by so many mirrors.
struct hemicube_level {
	struct hemicube_view *views;
	uint32_t count; // of them in use
	uint32_t *seen; // of each, which faces see which planes of mirrors, while there are some to look into
	uint32_t cell, plane; // the next of these
	struct gl_texture found; // for each pixel the mirror's plane + 1, and the weight that goes on
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
	uint32_t cells_most; // of a pass
	uint32_t rows_most; // of a batch
	uint32_t list_most; // elements that a row has room for
	float near; // metres
	bool compiled; // until then looks are only to run the programs
	double row_us; // 0: not known
	struct hemicube_clusters clusters;
	unsigned vertex_array;
	struct gl_buffer listed, corners, table, faces, cells, instances, draws, dense, rows, lists, entries, job;
	unsigned corner_texels, table_texels, cell_texels; // texel buffers
	struct hemicube_target target;
	struct gl_program *draw[2]; // of triangles without masks, and with; NULL: there are none
	struct gl_program *draw_mirrored[2]; // the same within mirrors; NULL: there are none
	struct gl_program *sum, *pack;
	struct gl_program *rays; // NULL: no light goes on by rays
	struct hemicube_cell *host_cells; // of a pass
	struct hemicube_seen *host_seen; // by a cell
	uint32_t *host_indices; // of all triangles: corners
	uint32_t *host_listed; // those of draws
	uint32_t listed_count, listed_most;
	struct hemicube_list *lists_of_draws; // HEMICUBE_LISTS
	struct hemicube_row *host_rows; // of a batch
	struct hemicube_level levels[HEMICUBE_PORTALS_MOST + 1]; // by mirrors on the way
	// Mirrors; empty where they are off or the scene has none.
	struct hemicube_planes planes;
	struct gl_buffer mirrors, seen, pixels;
	uint32_t seen_words; // of a cell
};

// Make the buffers that depend on the scene and on the table. On failure those that were made stay, for hemicube_destroy.
enum status hemicube_upload(struct hemicube *h, struct error *err);

// View a buffer as texels. STATUS_MEMORY, STATUS_DEVICE.
enum status hemicube_texels(struct hemicube *h, const struct gl_buffer *buffer, unsigned format, uint32_t texel_bytes,
			    unsigned *texture, struct error *err);

// Draw and sum up the cells of a level, and follow rays from them. Commands only.
enum status hemicube_pass(struct hemicube *h, uint32_t level, struct error *err);

// Sum up what the cells of the first level see, and what they see in mirrors.
enum status hemicube_look(struct hemicube *h, struct error *err);

// Look into the first mirror by a cell that may see nothing of it, so that the programs for it run.
enum status hemicube_look_anyway(struct hemicube *h, struct error *err);

// Whether mirrors are looked into.
static inline bool hemicube_has_portals(const struct hemicube *h)
{
	return h->planes.count > 0 && h->options.mirrors == HEMICUBE_MIRRORS_PORTAL;
}

// Whether rays go on from mirrors.
static inline bool hemicube_has_rays(const struct hemicube *h)
{
	return h->planes.count > 0 && h->options.mirrors == HEMICUBE_MIRRORS_HYBRID;
}

// Move what rows [0, count) have met to `entries`, with the first of each told in the buffer of rows. Commands only.
enum status hemicube_pack(const struct hemicube *h, uint32_t count, struct error *err);

#endif
