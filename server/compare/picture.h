// Reads and writes image files as linear RGB, and wraps OpenImageIO's perceptual metric. C interface to a C++ library. One
// thread for each picture.
#ifndef CANDIL_COMPARE_PICTURE_H
#define CANDIL_COMPARE_PICTURE_H

#include <stdint.h>

#include "server/base/error.h"

#ifdef __cplusplus
extern "C" {
#endif

struct picture {
	uint32_t width, height;
	float *rgb; // row by row from the top, 3 floats a pixel, linear; freed by picture_finish
};

// Read the channels R, G and B of any file that OpenImageIO reads. Without these names, take the first three channels; with
// fewer than three, the first one three times. 8-bit files that declare sRGB are decoded to linear. STATUS_IO if the file
// cannot be read, STATUS_LIMIT beyond LIMIT_SIDE a side or LIMIT_PIXELS, STATUS_MEMORY.
enum status picture_read(const char *path, struct picture *picture, struct error *err);
void picture_finish(struct picture *picture);

// Write sRGB codes, 3 bytes a pixel, as an 8-bit PNG. STATUS_IO, STATUS_ENCODE, STATUS_MEMORY.
enum status picture_write_png(const char *path, uint32_t width, uint32_t height, const uint8_t *codes, struct error *err);

// Count the pixels that an observer would see differ (Yee's metric with the library's defaults: 100 cd/m², 45 degrees). The
// pictures must have equal size and finite values. The library's version (2.4) finds differences of colour only: its test
// of luminance never triggers, not even for black against white.
enum status picture_perceptual(const struct picture *a, const struct picture *b, uint64_t *failures, struct error *err);

#ifdef __cplusplus
}
#endif

#endif
