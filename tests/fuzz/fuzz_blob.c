// A scene blob from a loader gone wrong: blob_check refuses it, or every section can be read to its end.
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "server/scene/blob.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct error err;
	void *blob = aligned_alloc(BLOB_ALIGN, (size / BLOB_ALIGN + 1) * BLOB_ALIGN);
	if (!blob)
		return 0;
	memcpy(blob, data, size);
	if (blob_check(blob, size, &err) == STATUS_OK)
		for (int s = 0; s < BLOB_SECTIONS; s++) {
			const unsigned char *bytes = blob_section(blob, (enum blob_section)s);
			const size_t n = blob_count(blob, (enum blob_section)s) * blob_stride((enum blob_section)s);
			for (size_t i = 0; i < n; i++)
				if (bytes + i >= (unsigned char *)blob + size)
					abort();
		}
	free(blob);
	return 0;
}
