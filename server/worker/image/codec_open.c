#include <dlfcn.h>

#include "server/worker/image/codec.h"

codec_function *codec_open(struct error *err)
{
	codec_function *encode = NULL;
	void *file = dlopen(CODEC_FILE, RTLD_NOW | RTLD_LOCAL);
	if (file)
		*(void **)&encode = dlsym(file, CODEC_NAME);
	if (!encode)
		error_set(err, STATUS_ENCODE, "%s", dlerror());
	return encode;
}
