// Edits for one request: what a job sees in place of its scene's own lights, materials and nodes. Everything that an edit
// leaves alone is the base's memory still; only sections that change are copied. Done on the CPU; no device is touched.
//
// Moved vertices come from the base's positions, in double: new world transform · inverse of the old. The BVH keeps its tree
// and gets new boxes (bvh_refit.h); where that makes it much worse a note says so. Tables of lights and emitters, bounds and
// facts are made again by the very functions of the loader, so that an edited scene is what the file would have given.
// One thread.
#ifndef CANDIL_WORKER_EDIT_H
#define CANDIL_WORKER_EDIT_H

#include "candil.pb.h"
#include "server/scene/blob.h"

#define EDIT_NOTE_BYTES 192u

// A node that stands elsewhere than in the base, and the triangles that went with it.
struct scene_move {
	uint32_t node; // of BLOB_SCENE_NODES
	uint32_t first_triangle, triangle_count; // by id; the count may be 0
};

// Hashes of what a scene's parts are now: equal parts, equal keys, whatever the edits that made them. What a technique
// derives from a part it may keep for as long as the key stays.
struct scene_keys {
	uint64_t geometry; // triangles and where they are; base scenes with another hash differ
	uint64_t lights; // point, spot and directional lights and their table
	uint64_t materials;
};

struct edited {
	struct blob_view view; // of the edited scene
	void *own[BLOB_SECTIONS]; // the sections that are ours; NULL: the base's
	struct scene_move *moves; // in the order of the nodes
	uint32_t move_count;
	struct scene_keys keys;
	double cost_ratio; // of the BVH's cost (bvh_cost) to the base's; 1 where nothing moved
	char note[EDIT_NOTE_BYTES]; // what a client should know; "" for nothing
};

// The keys of a scene as loaded.
struct scene_keys edit_keys(const struct blob_view *base);

// Apply checked edits to a scene as loaded, whose blob must outlive *out. STATUS_BAD_ARGUMENT for a name that the scene does
// not have or a node that cannot be moved there; STATUS_MEMORY. On failure nothing is left.
enum status edit_apply(const struct blob_view *base, const candil_Edits *edits, struct edited *out, struct error *err);

void edited_finish(struct edited *edited); // a zeroed one is fine

// ---- inside: one file each --------------------------------------------------------------------------------------------

// A copy of a section of the view, put in its place, with room for `more` elements behind. NULL without memory.
void *edit_own(struct edited *edited, enum blob_section section, uint32_t more);

// Where each node stands under the edits; world[i] is of node i. Fills in moves. edit_pose.c
enum status edit_pose(struct edited *edited, const candil_Edits *edits, struct transform *world, struct error *err);

// Triangles, BVH and bounds after the moves. edit_geometry.c
enum status edit_geometry(struct edited *edited, const struct transform *world, struct error *err);

// Materials by name. *changed: some is another now. edit_materials.c
enum status edit_materials(struct edited *edited, const candil_Edits *edits, bool *changed, struct error *err);

// Cameras and lights of moved nodes, lights of the request, tables. edit_lights.c
enum status edit_cameras(struct edited *edited, const struct transform *world, struct error *err);
enum status edit_lights(struct edited *edited, const candil_Edits *edits, const struct transform *world, struct error *err);
enum status edit_emitters(struct edited *edited, struct error *err);

#endif
