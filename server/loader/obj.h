// Imports OBJ and MTL files. One thread.
#ifndef CANDIL_LOADER_OBJ_H
#define CANDIL_LOADER_OBJ_H

#include "server/loader/import.h"

// Import the file. `name` is its name in the scene's folder, `bytes` its content. import->z_up and import->unit apply.
// STATUS_SCENE_INVALID, with the number of the line, STATUS_SCENE_LIMIT, STATUS_MEMORY. A missing MTL or texture is only a
// warning, and so is a statement that is not known.
enum status obj_import(struct import *import, const char *name, const struct file_bytes *bytes, struct error *err);

#endif
