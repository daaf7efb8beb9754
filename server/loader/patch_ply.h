// Reads a file of patches, as the worker writes them (patch_file.h), as a scene of its own: its elements, every number as
// the file has it, bit for bit. One thread.
#ifndef CANDIL_LOADER_PATCH_PLY_H
#define CANDIL_LOADER_PATCH_PLY_H

#include "server/loader/import.h"

// Read a PLY, binary_little_endian 1.0, of vertices and then faces (Turk 1994); `file` is its name for messages. Properties
// are found by name, in any order; further ones that are single numbers are passed over. Takes time linear in the bytes.
// STATUS_SCENE_UNSUPPORTED: it is a PLY of something else, such as a mesh. STATUS_SCENE_INVALID: the header, a count or a
// number is wrong. STATUS_SCENE_LIMIT (faces), STATUS_MEMORY.
enum status patch_ply_import(struct import *import, const char *file, const struct file_bytes *bytes, struct error *err);

#endif
