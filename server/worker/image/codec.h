// Encoding of frames through OpenImageIO, behind C. The only header of the worker's that C++ implements.
#ifndef CANDIL_WORKER_CODEC_H
#define CANDIL_WORKER_CODEC_H

#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/worker/image/frame.h"

#ifdef __cplusplus
extern "C" {
#endif

enum codec_format { CODEC_EXR_HALF, CODEC_EXR_FLOAT, CODEC_PNG }; // the numbers of candil_Format
enum codec_view { CODEC_VIEW_NONE, CODEC_VIEW_REINHARD, CODEC_VIEW_FILMIC }; // of candil_View

// Encode `frame` into a new sealed memfd of *bytes. EXR: linear Rec.709 R G B (half or float), then Z, N.X N.Y N.Z,
// albedo.R albedo.G albedo.B (float or half alike; Z always float) and id (UINT), metadata as candil/* attributes.
// PNG: 8 bits, sRGB, after 2^exposure_ev and the view transform; both named in the file with the metadata.
// STATUS_ENCODE if the library refuses. Thread-safe for different frames.
enum status codec_encode(const struct frame *frame, enum codec_format format, enum codec_view view, double exposure_ev,
			 int *fd, size_t *bytes, struct error *err);

#ifdef __cplusplus
}
#endif

#endif
