// The vertices of an OBJ mesh. assimp gives each corner of each face one of its own; those that are the same in every bit
// become one here, which takes two fifths of a scene's bytes.
#ifndef CANDIL_LOADER_OBJ_VERTICES_H
#define CANDIL_LOADER_OBJ_VERTICES_H

#include <assimp/mesh.h>

#include "server/loader/import.h"

// Add the distinct vertices of a mesh. *number, from malloc and the caller's, says for each of the mesh's where it is among
// the import's; NULL for a mesh without vertices, and on failure.
enum status obj_add_vertices(struct import *im, const struct aiMesh *mesh, uint32_t **number, struct error *err);

#endif
