// Patches: the faces of a scene (patch_faces.h) cut into pieces of a bounded size, for radiosity. A quad is cut into a grid,
// a triangle into n² triangles. Inside a face no patch has a neighbour's corner on its side. Across faces none has where
// both cut their common edge into as many parts, as faces of one size do; corners on it are then the same to the bit. Only
// faces are kept: a patch is made when it is asked for. Patches have one side, the front. Host only, any thread.
//
// Example: `scene` is a view of a blob
//	struct patches patches;
//	struct error err;
//	assert(patches_init(&patches, scene, &(struct patch_options){.edge = 0.1}, &err) == STATUS_OK);
//	double area = 0;
//	for (uint32_t i = 0; i < patches.count; i++) {
//		struct patch p;
//		patches_get(&patches, i, &p);
//		area += p.area;
//	}
//	printf("%u patches of %g m²\n", patches.count, area);
//	patches_finish(&patches);
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_PATCHES_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_PATCHES_H

#include "server/worker/technique/radiosity/form_factor.h"
#include "server/worker/technique/radiosity/patch_faces.h"

#define PATCHES_MOST (1u << 20) // of a scene

// How fine a scene is cut: by `edge`, or where that is 0 by `count`.
struct patch_options {
	double edge; // metres, above 0: a patch's sides are no longer
	uint32_t count; // as many patches or somewhat less, but at least one a face
};

// How a face is cut.
struct patch_cut {
	uint32_t first; // number of its first patch
	uint32_t u,
	    v; // parts of a quad's sides 0 1 and 1 2, and of those opposite; of each side of a triangle `u`, and v is 0
};

// All patches of a scene.
struct patches {
	struct patch_faces faces;
	struct patch_cut *cuts; // by face
	uint32_t count;
	double edge; // by which they were cut, metres
	const struct vertex *vertices; // the scene's
	const struct triangle *triangles;
};

// A patch.
struct patch {
	struct form_polygon shape; // metres, relative to the blob's origin; three corners or four
	double normal[3]; // unit
	double area; // m²
	uint32_t material;
	uint32_t triangle[2]; // that it is of; the second NONE: of one
	uint32_t face;
};

// Memory that patches_init needs for a scene of so many triangles, in bytes, at most.
uint64_t patches_bytes(uint32_t triangles);

// Cut a scene. The view's sections must outlive the patches, which patches_finish frees. STATUS_LIMIT: there would be more
// than PATCHES_MOST; the sentence tells what would do. STATUS_BAD_ARGUMENT: an edge
// that is no length, or neither is given; and as patch_faces_init. `patches` is empty then.
enum status patches_init(struct patches *patches, const struct blob_view *scene, const struct patch_options *options,
			 struct error *err);

// Free them. Patches that are all zero are fine.
void patches_finish(struct patches *patches);

// Make the patch i, below `count`. Numbers run face by face. In a quad's grid they run along its side 0 1 first.
void patches_get(const struct patches *patches, uint32_t i, struct patch *out);

#endif
