// A hostile OBJ file and its MTL, which is what follows the first byte 0.
#include <string.h>

#include "server/loader/obj.h"
#include "tests/fuzz/import_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static enum status read_obj(struct import *import, const struct file_bytes *bytes, struct error *err)
{
	return obj_import(import, "scene.obj", bytes, err);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const uint8_t *end = memchr(data, 0, size);
	const size_t obj = end ? (size_t)(end - data) : size;
	if (end)
		import_file_write("scene.mtl", end + 1, size - obj - 1);
	else
		import_file_write("scene.mtl", data, 0);
	import_file(read_obj, data, obj);
	return 0;
}
