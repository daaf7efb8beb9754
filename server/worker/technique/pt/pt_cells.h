// The cells of textured emissive triangles on the device (server/scene/emitter_cells.h), made for the first job that wants
// them and kept with the scene. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_CELLS_H
#define CANDIL_WORKER_TECHNIQUE_PT_CELLS_H

#include "server/scene/emitter_cells.h"
#include "server/worker/plan/plan.h"
#include "server/worker/scenes/resident.h"

// What the resident scene owns of them.
struct pt_cells {
	struct buffer grids; // struct emitter_grid
	struct buffer cells; // struct emitter_cell
	struct buffer emitters; // struct emitter, in the place of BIND_EMITTERS
	struct emitter_cells tables; // their content: `grids` and the numbers; what only the device reads is gone
};

// Whether a job chooses places on emissive triangles by their cells: some emission has a texture that the plan simulates.
bool pt_cells_wanted(const struct resident_scene *scene, const struct plan *plan);

// Device memory of the cells, in bytes. It reads all emitters unless the cells are there.
uint64_t pt_cells_bytes(const struct resident_scene *scene);

// The scene's cells, made unless they are there. They live as long as the scene is on the device. STATUS_MEMORY,
// STATUS_DEVICE.
enum status pt_cells_get(struct device *device, struct resident_scene *scene, const struct pt_cells **out,
			 struct error *err);

#endif
