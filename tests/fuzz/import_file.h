// Imports scene files as candil-loader does, from a folder of the target's own.
#ifndef CANDIL_TESTS_IMPORT_FILE_H
#define CANDIL_TESTS_IMPORT_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "server/loader/import.h"

typedef enum status importer(struct import *import, const struct file_bytes *bytes, struct error *err);

// Put a file into the folder, in place of one of that name.
void import_file_write(const char *name, const uint8_t *data, size_t size);

// Import `data` and, where the scene is small, make its blob and check that the worker would take it. The folder has an
// image, map.png.
void import_file(importer *read, const uint8_t *data, size_t size);

#endif
