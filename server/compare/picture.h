// Reads and writes image files as linear RGB. C interface to a C++ library. One thread for each picture.
#ifndef CANDIL_COMPARE_PICTURE_H
#define CANDIL_COMPARE_PICTURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/compare/origin.h"

#ifdef __cplusplus
extern "C" {
#endif

struct picture {
	uint32_t width, height;
	float *rgb; // row by row from the top, 3 floats a pixel, linear; freed by picture_finish
	bool is_display; // the file has whole numbers, which are what a display shows; otherwise radiance
	struct origin origin;
};

// Read the channels R, G and B of any file that OpenImageIO reads. Without these names, take the first three channels; with
// fewer than three, the first one three times. 8-bit files that declare sRGB are decoded to linear. STATUS_IO if the file
// cannot be read, STATUS_LIMIT beyond LIMIT_SIDE a side or LIMIT_PIXELS, STATUS_MEMORY.
enum status picture_read(const char *path, struct picture *picture, struct error *err);
void picture_finish(struct picture *picture);

// Encode sRGB codes, 3 bytes a pixel, as "png" or "jpeg" (8 bits, quality 90, no colours left out): `bytes` is to be freed.
// STATUS_ENCODE, STATUS_MEMORY.
enum status picture_encode(const char *format, uint32_t width, uint32_t height, const uint8_t *codes, uint8_t **bytes,
			   size_t *size, struct error *err);

#ifdef __cplusplus
}
#endif

#endif
