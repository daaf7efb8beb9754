// A hostile file of patches, or of form factors where it begins as a Matrix Market file does.
#include <string.h>

#include "server/loader/patch_matrix.h"
#include "server/loader/patch_ply.h"
#include "tests/fuzz/import_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static enum status read_patches(struct import *import, const struct file_bytes *bytes, struct error *err)
{
	const bool matrix = bytes->size >= 2 && memcmp(bytes->data, "%%", 2) == 0;
	return matrix ? patch_matrix_import(import, "a.mtx", bytes, err) : patch_ply_import(import, "a.ply", bytes, err);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	import_file(read_patches, data, size);
	return 0;
}
