#include <dlfcn.h>

#include "server/base/library.h"
#include "server/base/room.h"
#include "server/base/room_need.h"
#include "server/worker/image/codec.h"

codec_function *codec_open(struct error *err)
{
	codec_function *encode = NULL;
	if (room_need(ROOM_IMAGES_BYTES, "the codec of pictures", err) != STATUS_OK)
		return NULL;
	*(void **)&encode = library_symbol(CODEC_FILE, RTLD_NOW | RTLD_LOCAL, CODEC_NAME, STATUS_ENCODE, err);
	return encode;
}
