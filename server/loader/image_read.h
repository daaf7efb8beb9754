// Encoded images to RGBA8 texels or to linear floats, through OpenImageIO. The size is known, and checked, before a pixel is
// read. One thread.
#ifndef CANDIL_LOADER_IMAGE_READ_H
#define CANDIL_LOADER_IMAGE_READ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

#ifdef __cplusplus
extern "C" {
#endif

struct image_reader;

// Recognise an image by its first bytes (png, jpeg; with `any_format` also bmp, tiff, and tga by `name`'s ending) and read
// its size, 1 … LIMIT_TEXTURE_SIDE each way. `bytes` must outlive the reader. Any failure: *reader is NULL and err says why.
enum status image_open(const uint8_t *bytes, size_t size, const char *name, bool any_format, struct image_reader **reader,
		       uint32_t *width, uint32_t *height, struct error *err);

// width · height texels, rows from the top, red in the low byte. 16-bit and float channels become 8 bits, grey becomes RGB,
// a missing alpha 255; colours are not multiplied by alpha.
enum status image_pixels(struct image_reader *reader, uint32_t *texels, struct error *err);

// The same for a picture of the surroundings: exr, hdr, tiff, png, jpeg. One whose pixels are not its whole window is
// refused.
enum status image_open_surroundings(const uint8_t *bytes, size_t size, struct image_reader **reader, uint32_t *width,
				    uint32_t *height, struct error *err);

// width · height · 3 floats, rows from the top, as they stand in the file: anything, NaN included. Whole numbers are decoded
// from sRGB to 0…1; grey becomes RGB; what lies behind the third channel is not read.
enum status image_radiance(struct image_reader *reader, float *rgb, struct error *err);

void image_close(struct image_reader *reader);

#ifdef __cplusplus
}
#endif

#endif
