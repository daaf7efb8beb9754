// Encoding of frames as files by OpenImageIO, with a C interface. The worker's only header that C++ implements.
//
// Design note. OpenImageIO brings two hundred and fifty libraries. Linking them takes a third of a second of a processor, so
// the worker does it when its first scene comes, not before it is ready: the codec is a shared object of its own.
#ifndef CANDIL_WORKER_CODEC_H
#define CANDIL_WORKER_CODEC_H

#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/worker/image/frame.h"

#define CODEC_FILE "candil-codec.so" // beside the worker
#define CODEC_NAME "codec_encode"

#ifdef __cplusplus
extern "C" {
#endif

// File formats, with the numbers of candil_Format.
enum codec_format { CODEC_EXR_HALF, CODEC_EXR_FLOAT, CODEC_PNG };

// View transforms (view.h), with the numbers of candil_View.
enum codec_view { CODEC_VIEW_NONE, CODEC_VIEW_REINHARD, CODEC_VIEW_FILMIC };

// Encode a frame into a new sealed memfd. *fd is the caller's to close; *bytes is the file's size.
//
// EXR: linear Rec.709 R G B, half or float; then Z (always float), N.X N.Y N.Z, albedo.R albedo.G albedo.B (of the type of
// R G B) and id (UINT); metadata as candil/* attributes. `view` and `exposure_ev` are ignored.
// PNG: 8-bit sRGB after the exposure and the view transform, both named in the file with the metadata.
//
// STATUS_ENCODE if the library refuses; STATUS_MEMORY. Any thread, but a frame in one thread at a time.
typedef enum status codec_function(const struct frame *frame, enum codec_format format, enum codec_view view,
				   double exposure_ev, int *fd, size_t *bytes, struct error *err);

// The function, for those who link it.
codec_function codec_encode;

// The same from CODEC_FILE, which stays linked. NULL on failure: STATUS_ENCODE, with what the linker says, or STATUS_MEMORY.
// Any thread.
codec_function *codec_open(struct error *err);

#ifdef __cplusplus
}
#endif

#endif
