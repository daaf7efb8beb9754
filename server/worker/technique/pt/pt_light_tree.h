// The tree over a scene's lamps, for the path tracer: made at the first job that wants it, kept with the scene. Of a job
// that leaves out emissive triangles or lights, the tree is over the others. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_LIGHT_TREE_H
#define CANDIL_WORKER_TECHNIQUE_PT_LIGHT_TREE_H

#include "server/worker/devices.h"
#include "server/worker/plan/plan.h"
#include "server/worker/scenes/resident.h"

struct pt_light_tree {
	struct buffer nodes; // struct light_node
	struct buffer trails; // uint, one an emitter
};

// Whether a job chooses lamps by the tree: pt.light_tree says so, or there are many, or some that are near to what they
// light and so all the world to it, whatever their power.
bool pt_light_tree_wanted(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan);

// Device memory of the tree, in bytes.
uint64_t pt_light_tree_bytes(const struct resident_scene *scene, const struct plan *plan);

// The scene's tree for such jobs; it lives as long as the scene is on the device. *us grows by the time that making it took.
enum status pt_light_tree_get(struct device *device, struct resident_scene *scene, const struct plan *plan,
			      const struct pt_light_tree **out, uint64_t *us, struct error *err);

#endif
