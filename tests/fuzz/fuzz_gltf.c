// A hostile glTF or GLB file, whose buffers and images are within it.
#include "server/loader/gltf.h"
#include "tests/fuzz/import_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	import_file(gltf_import, data, size);
	return 0;
}
