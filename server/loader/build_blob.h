// From an import to the sealed blob. One thread.
#ifndef CANDIL_LOADER_BUILD_BLOB_H
#define CANDIL_LOADER_BUILD_BLOB_H

#include "server/loader/import.h"

// Consumes the import's vertices (freed here; the rest stays the caller's). Drops triangles that are not finite or have no
// area, and counts them in import->info, whose remaining fields are filled in. *fd is a sealed memfd that the caller owns.
enum status build_blob(struct import *import, int *fd, struct error *err);

#endif
