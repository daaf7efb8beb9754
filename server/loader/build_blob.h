// Makes a sealed blob from an import. One thread.
#ifndef CANDIL_LOADER_BUILD_BLOB_H
#define CANDIL_LOADER_BUILD_BLOB_H

#include "server/loader/import.h"

// Build the blob. Frees the import's vertices; the rest of the import remains the caller's. Triangles that are not finite
// or have no area are dropped and counted in import->info, whose remaining fields are filled in. *fd becomes a sealed memfd
// that the caller owns. STATUS_SCENE_LIMIT, STATUS_MEMORY, STATUS_INTERNAL.
enum status build_blob(struct import *import, int *fd, struct error *err);

#endif
