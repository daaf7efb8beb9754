// Where on textured emissive triangles the light comes from. Each is divided into 4^level congruent cells, as shaders find
// them by barycentrics (shaders/common/emitter_cells.glsl), and an alias table chooses among a triangle's cells by their
// mean emission. A share of CELL_EVEN stays even over the triangle, so that no place that the texture's filter lights has
// density 0. Triangles without an emissive texture share one cell. Equal input gives equal bits. One thread.
#ifndef CANDIL_SCENE_EMITTER_CELLS_H
#define CANDIL_SCENE_EMITTER_CELLS_H

#include <stdbool.h>

#include "server/scene/blob.h"

#define CELL_LEVEL_MAX 8u // 65536 cells
#define CELLS_MAX (1u << 20) // of a scene; beyond it all triangles have lower levels, down to a cell each
#define CELL_EVEN 0.0625

// The tables of a scene's emitters. Owned by the caller, who ends them by emitter_cells_finish; zeroed: none.
struct emitter_cells {
	struct emitter_grid *grids; // one for each emitter
	struct emitter_cell *cells;
	struct emitter *emitters; // BLOB_EMITTERS with the probabilities that follow from the cells
	uint32_t count, cell_count;
	float power; // W, of the emitters as that table weighs them
};

// Whether some emitter's emission has a texture.
bool emitter_cells_wanted(const struct blob_view *scene);

// The number of cells that emitter_cells_init makes of a scene: at least one. It reads all emitters.
uint32_t emitter_cells_count(const struct blob_view *scene);

// Make the tables of a scene that has emitters. Every texel of an emissive image is read once, by however many materials it
// is used. STATUS_MEMORY.
enum status emitter_cells_init(struct emitter_cells *out, const struct blob_view *scene, struct error *err);

// Free what only the device reads, `cells` and `emitters`: they become NULL.
void emitter_cells_trim(struct emitter_cells *cells);

void emitter_cells_finish(struct emitter_cells *cells);

#endif
