// Imports glTF 2.0 and GLB files, through tinygltf behind our own checks. One thread.
#ifndef CANDIL_LOADER_GLTF_H
#define CANDIL_LOADER_GLTF_H

#include "server/loader/import.h"

#ifdef __cplusplus
extern "C" {
#endif

// Import the file whose content is `bytes`, JSON or GLB. STATUS_SCENE_INVALID: it violates the format.
// STATUS_SCENE_UNSUPPORTED: it requires an extension that is not known here. STATUS_SCENE_FILE, STATUS_SCENE_PATH: a buffer
// cannot be read. STATUS_SCENE_LIMIT, STATUS_MEMORY.
enum status gltf_import(struct import *import, const struct file_bytes *bytes, struct error *err);

#ifdef __cplusplus
}
#endif

#endif
