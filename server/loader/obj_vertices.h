// The vertices of an OBJ mesh. assimp gives each corner of each face its own vertex. Vertices that are equal in every bit
// are merged here, which saves two fifths of a scene's bytes. One thread.
#ifndef CANDIL_LOADER_OBJ_VERTICES_H
#define CANDIL_LOADER_OBJ_VERTICES_H

#include <assimp/mesh.h>

#include "server/loader/import.h"

// Add the distinct vertices of a mesh. *number becomes an array that the caller frees: for each of the mesh's vertices its
// index in the import. It is NULL for a mesh without vertices, and on failure. STATUS_SCENE_LIMIT, STATUS_MEMORY.
enum status obj_add_vertices(struct import *im, const struct aiMesh *mesh, uint32_t **number, struct error *err);

#endif
