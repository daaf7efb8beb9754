// The light tree over a scene's lamps on the device (server/scene/light_tree.h), made for the first job that wants it and
// kept with the scene. If a job leaves out emissive triangles or lights, its tree is over the others. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_LIGHT_TREE_H
#define CANDIL_WORKER_TECHNIQUE_PT_LIGHT_TREE_H

#include "server/scene/emitter_cells.h"
#include "server/worker/devices.h"
#include "server/worker/plan/plan.h"
#include "server/worker/scenes/resident.h"

// The tree's buffers, which the resident scene owns.
struct pt_light_tree {
	struct buffer nodes; // struct light_node
	struct buffer trails; // a uint for each emitter: its way down the tree
};

// Whether a job chooses lamps by the tree: pt.light_tree says so, or it is `auto` and there are enough lamps.
bool pt_light_tree_wanted(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan);

// Device memory of the tree, in bytes.
uint64_t pt_light_tree_bytes(const struct resident_scene *scene, const struct plan *plan);

// The scene's tree for a job of this plan, with the emitters' light as `cells` has it (NULL: there are none), made unless it
// is there. It lives as long as the scene is on the device. *us grows by the time that making it took. STATUS_MEMORY,
// STATUS_DEVICE.
enum status pt_light_tree_get(struct device *device, struct resident_scene *scene, const struct plan *plan,
			      const struct emitter_cells *cells, const struct pt_light_tree **out, uint64_t *us,
			      struct error *err);

#endif
