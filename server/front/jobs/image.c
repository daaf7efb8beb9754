#include "server/front/jobs/image.h"

#include <unistd.h>

#include "protocol/header.h"
#include "protocol/limits.h"
#include "protocol/names.h"
#include "server/front/reply.h"
#include "server/front/session.h"

uint64_t image_estimate(const candil_Render *render)
{
	uint32_t channels = 3;
	if (!format_is_picture(render->format))
		return LIMIT_PATCH_FILE_BYTES;
	if (render->aovs & AOV_DEPTH)
		channels += 1;
	if (render->aovs & AOV_NORMAL)
		channels += 3;
	if (render->aovs & AOV_ALBEDO)
		channels += 3;
	if (render->aovs & AOV_ID)
		channels += 1;
	uint32_t bytes = render->format == candil_Format_FORMAT_PNG ? 1 : 4;
	return (uint64_t)render->width * render->height * channels * bytes + 65536;
}

void image_init(struct image *image)
{
	*image = (struct image){.fd = -1};
}

bool image_is_scaled(const candil_ImageFrame *frame)
{
	return frame->made_width != frame->width || frame->made_height != frame->height;
}

void image_set(struct image *image, int fd, const candil_ImageFrame *frame)
{
	*image = (struct image){.place = image->place, .estimate = image->estimate, .fd = fd, .frame = *frame};
}

bool image_waits(const struct image *image)
{
	return image->fd >= 0;
}

bool image_is_sent(const struct image *image)
{
	return image->announced && image->sent == image->frame.bytes;
}

bool image_pump(struct image *image, struct session *session, uint32_t request, bool *broken)
{
	*broken = false;
	if (!session_has_room(session, LIMIT_CHUNK_BYTES))
		return false;
	if (!image->announced) {
		reply_message(session, MESSAGE_IMAGE, request, candil_ImageFrame_fields, &image->frame);
		image->announced = true;
		return true;
	}
	uint64_t left = image->frame.bytes - image->sent;
	uint32_t bytes = left < LIMIT_CHUNK_BYTES ? (uint32_t)left : LIMIT_CHUNK_BYTES;
	uint8_t *room = session_room(session, bytes);
	if (!room)
		return false;
	// The memfd is sealed, so it is still as long as it was when it was measured.
	if (pread(image->fd, room, bytes, (off_t)image->sent) != (ssize_t)bytes) {
		*broken = true;
		return false;
	}
	session_commit(session, MESSAGE_FRAME_CHUNK, request, bytes);
	image->sent += bytes;
	return true;
}

void image_close(struct image *image)
{
	if (image->fd >= 0)
		close(image->fd);
	*image = (struct image){.place = image->place, .fd = -1};
}
