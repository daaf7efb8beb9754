#include <dlfcn.h>

#include "server/loader/image_read.h"

const struct image_decoder *image_decoder_open(struct error *err)
{
	// Its symbols are global, so that the sandbox finds who starts threads.
	void *file = dlopen(IMAGE_DECODER_FILE, RTLD_NOW | RTLD_GLOBAL);
	const struct image_decoder *decoder = file ? dlsym(file, IMAGE_DECODER_NAME) : NULL;
	if (!decoder)
		error_set(err, STATUS_INTERNAL, "%s", dlerror());
	return decoder;
}
