#include <dlfcn.h>

#include "server/base/library.h"
#include "server/base/room.h"
#include "server/base/room_need.h"
#include "server/loader/image_read.h"

const struct image_decoder *image_decoder_open(struct error *err)
{
	if (room_need(ROOM_IMAGES_BYTES, "the decoder of the scene's images", err) != STATUS_OK)
		return NULL;
	// Its symbols are global, so that the sandbox finds who starts threads.
	return library_symbol(IMAGE_DECODER_FILE, RTLD_NOW | RTLD_GLOBAL, IMAGE_DECODER_NAME, STATUS_INTERNAL, err);
}
