// Makes the renderer's materials of those of MTL files: colours, maps, and the surface that mtl_surface.h finds. One thread.
#ifndef CANDIL_LOADER_MTL_MATERIAL_H
#define CANDIL_LOADER_MTL_MATERIAL_H

#include "server/loader/mtl_notes.h"

// Add a material to the import for every note, in their order. A surface without Kd has the colour of its map, or else this
// albedo. What no file defines although a face uses it is told. STATUS_SCENE_LIMIT, STATUS_MEMORY.
enum status mtl_materials_add(struct import *import, const struct mtl_notes *notes, float albedo, struct error *err);

#endif
