// Imports OBJ and MTL files, through assimp's C API with our own file access. One thread.
#ifndef CANDIL_LOADER_OBJ_H
#define CANDIL_LOADER_OBJ_H

#include "server/loader/import.h"

// Import the file. `name` is its name in the scene's folder, `bytes` its content. import->z_up and import->unit apply.
// STATUS_SCENE_INVALID, STATUS_SCENE_LIMIT, STATUS_MEMORY. A missing MTL or texture is only a warning.
enum status obj_import(struct import *import, const char *name, const struct file_bytes *bytes, struct error *err);

#endif
