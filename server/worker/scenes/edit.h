// The edits of one request: the lights, materials and nodes that a job sees in place of its scene's own. Sections that an
// edit changes are copied; all others remain the base's memory. Host only, on one thread.
//
// Moved vertices are computed from the base's positions in double precision: new world transform · inverse of the old one.
// The BVH keeps its tree and gets new boxes (bvh_refit.h); a note tells where that makes it much slower. Tables of lights
// and emitters, bounds and facts are made again by the loader's own functions, so an edited scene equals what the file would
// give.
#ifndef CANDIL_WORKER_EDIT_H
#define CANDIL_WORKER_EDIT_H

#include "candil.pb.h"
#include "server/scene/blob.h"

#define EDIT_NOTE_BYTES 192u

// A node whose world transform differs from the base's, and its triangles.
struct scene_move {
	uint32_t node; // of BLOB_SCENE_NODES
	uint32_t first_triangle, triangle_count; // by id; the count may be 0
};

// Hashes of a scene's parts: equal parts have equal keys, whatever edits made them. What a technique derives from a part is
// good for every scene with the same key.
struct scene_keys {
	uint64_t geometry; // triangles and their places; base scenes of different hashes differ
	uint64_t lights; // point, spot and directional lights and their table
	uint64_t materials;
};

// An edited scene. Zeroed: none.
struct edited {
	struct blob_view view; // of the edited scene
	void *own[BLOB_SECTIONS]; // copies of the sections that changed, freed by edited_finish; NULL: the base's
	struct scene_move *moves; // in the order of the nodes
	uint32_t move_count;
	struct scene_keys keys;
	double cost_ratio; // the BVH's cost (bvh_cost) over that of the base's; 1 where nothing moved
	char note[EDIT_NOTE_BYTES]; // what a client should know; "" for nothing
};

// The keys of a scene as loaded.
struct scene_keys edit_keys(const struct blob_view *base);

// Apply edits that have passed the front's check to a scene as loaded, whose blob must outlive *out. STATUS_BAD_ARGUMENT for
// a name that the scene does not have or a node that cannot be moved there; STATUS_MEMORY. On failure *out is zeroed.
enum status edit_apply(const struct blob_view *base, const candil_Edits *edits, struct edited *out, struct error *err);

// Free what edit_apply allocated. A zeroed one is fine.
void edited_finish(struct edited *edited);

// ---- the steps of edit_apply, in files of their own; they fail as it does ----------------------------------------------

// Copy a section as the view has it now, with room for `more` elements behind, put the copy in its place, and return it.
// NULL: out of memory, and nothing has changed.
void *edit_own(struct edited *edited, enum blob_section section, uint32_t more);

// Compute each node's world transform under the edits, world[i] that of node i, and fill in `moves`. edit_pose.c
enum status edit_pose(struct edited *edited, const candil_Edits *edits, struct transform *world, struct error *err);

// Move the triangles of moved nodes; make boxes of the BVH and bounds again. edit_geometry.c
enum status edit_geometry(struct edited *edited, const struct transform *world, struct error *err);

// Change materials by name. *changed: at least one is different now. edit_materials.c
enum status edit_materials(struct edited *edited, const candil_Edits *edits, bool *changed, struct error *err);

// Move the cameras of moved nodes. edit_lights.c
enum status edit_cameras(struct edited *edited, const struct transform *world, struct error *err);

// Move the lights of moved nodes, add the request's lights or put them in the place of all, and make the alias table again.
enum status edit_lights(struct edited *edited, const candil_Edits *edits, const struct transform *world, struct error *err);

// Make the list of emissive triangles and its alias table again.
enum status edit_emitters(struct edited *edited, struct error *err);

#endif
