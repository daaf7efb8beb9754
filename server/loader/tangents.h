// Tangents for normal maps where the file gives none. One thread.
#ifndef CANDIL_LOADER_TANGENTS_H
#define CANDIL_LOADER_TANGENTS_H

#include "server/loader/geometry.h"

// Fill in out->tangents, already there, for the corners of normal-mapped triangles that have none. The tangent points along
// growing u of the normal map, as its transform leaves it; bitangent = sign · cross(normal, tangent) points up in the map,
// along falling v. Contributions are weighted by a corner's angle and averaged over the corners that agree in position,
// normal, coordinates and handedness, whichever vertices they use; a vertex whose corners disagree is doubled. Flat
// surfaces take the triangle's normal. Triangles without area in the map contribute nothing: a vertex that has only such
// keeps a zero tangent.
//
// STATUS_SCENE_LIMIT if the vertices become too many, STATUS_MEMORY.
enum status tangents_build(const struct import *import, struct geometry *out, struct error *err);

#endif
