// Image files as linear RGB, and OpenImageIO's perceptual metric: the C++ library behind C.
#ifndef CANDIL_COMPARE_PICTURE_H
#define CANDIL_COMPARE_PICTURE_H

#include <stdint.h>

#include "server/base/error.h"

#ifdef __cplusplus
extern "C" {
#endif

struct picture {
	uint32_t width, height;
	float *rgb; // row by row from the top, 3 floats a pixel, linear; malloc'd
};

// Read the channels R, G and B (else the first three; else the first, three times) of any file that OpenImageIO reads. Files
// that say sRGB are decoded to linear. At most LIMIT_SIDE a side and LIMIT_PIXELS. STATUS_IO if it cannot be read.
enum status picture_read(const char *path, struct picture *picture, struct error *err);
void picture_finish(struct picture *picture);

// Write 8-bit sRGB codes, 3 bytes a pixel, as a PNG.
enum status picture_write_png(const char *path, uint32_t width, uint32_t height, const uint8_t *codes, struct error *err);

// Pixels that an observer would see differ (Yee's metric, the library's defaults: 100 cd/m², 45 degrees). Pictures of equal
// size, every value finite. The library's version (2.4) finds differences of colour only: its test of luminance never
// fires, not even for black against white.
enum status picture_perceptual(const struct picture *a, const struct picture *b, uint64_t *failures, struct error *err);

#ifdef __cplusplus
}
#endif

#endif
