// Computes tangents for normal maps if the file gives none. One thread.
#ifndef CANDIL_LOADER_TANGENTS_H
#define CANDIL_LOADER_TANGENTS_H

#include "server/loader/geometry.h"

// Fill in those tangents of out->tangents, an existing array, that corners of normal-mapped triangles lack. A tangent
// points along growing u of the normal map, after the texture's transform. The bitangent, sign · cross(normal, tangent),
// points up in the map, along falling v. Contributions are weighted by the corner's angle and averaged over corners that
// agree in position, normal, coordinates and handedness, whichever vertices they use. A vertex whose corners disagree is
// duplicated. Flat surfaces use the triangle's normal. Triangles without area in the map contribute nothing: a vertex that
// has only such triangles keeps a zero tangent.
//
// STATUS_SCENE_LIMIT if there are too many vertices, STATUS_MEMORY.
enum status tangents_build(const struct import *import, struct geometry *out, struct error *err);

#endif
