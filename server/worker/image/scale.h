// Scaling a picture up to more pixels. Any thread.
#ifndef CANDIL_WORKER_SCALE_H
#define CANDIL_WORKER_SCALE_H

#include "server/worker/image/frame.h"

// Give a frame `width` × `height` pixels, at least as many as it has each way. Radiance is interpolated between the nearest
// four pixels' centres, and stays what it is beyond the outermost; AOVs and `met` are those of the nearest pixel. made_width
// and made_height stay. On failure the frame is as it was: STATUS_MEMORY.
enum status frame_scale(struct frame *frame, uint32_t width, uint32_t height, struct error *err);

// Fill what lies behind the first frame->ahead tiles of a frame, of `side` pixels each way, from another one of the same
// size, with the same AOVs.
void frame_fill(struct frame *frame, const struct frame *from, uint32_t side);

#endif
