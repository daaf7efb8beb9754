// The faces of a scene, from which patches are cut: two triangles that are a flat convex quad are one face, any other
// triangle is one by itself. The two have one material, an edge in common, which they run along in opposite directions, and
// lie in one plane but for the rounding of floats. Of several partners a triangle gets the one with which it is most like a
// rectangle. Vertices count by their places: a quad stays one whose triangles have vertices of their own, for normals or
// textures. Host only, any thread.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_PATCH_FACES_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_PATCH_FACES_H

#include "server/base/error.h"
#include "server/scene/blob.h"

#define PATCH_FACES_MOST (1u << 20) // of a scene, and half of its triangles

// A face, its corners counter-clockwise seen from its front.
struct patch_face {
	uint32_t corner[4]; // vertices of the scene; the last is NONE: a triangle
	uint32_t triangle[2]; // by id: of corners 0 1 2, and of 0 2 3, or NONE
};

// The faces, in the order of their first triangles.
struct patch_faces {
	struct patch_face *list;
	uint32_t count;
	uint32_t skipped; // triangles without an area, which are in no face
};

// Memory that patch_faces_init needs for so many triangles, in bytes, at most. The faces keep a part of it.
uint64_t patch_faces_bytes(uint32_t triangles);

// Find the faces of a scene; patch_faces_finish frees them. STATUS_SCENE_LIMIT: it has more than 2 PATCH_FACES_MOST
// triangles, or more faces than that; STATUS_MEMORY. `faces` is empty then.
enum status patch_faces_init(struct patch_faces *faces, const struct blob_view *scene, struct error *err);

// Free them. Faces that are all zero are fine.
void patch_faces_finish(struct patch_faces *faces);

#endif
