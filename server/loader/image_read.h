// Decodes images to texels or to linear floats, through OpenImageIO. The size is known, and checked, before a pixel
// is read. Failures of decoding are STATUS_SCENE_INVALID, unknown formats STATUS_SCENE_UNSUPPORTED, sizes beyond a limit
// STATUS_SCENE_LIMIT. One thread.
//
// Design note. OpenImageIO brings two hundred and fifty libraries, and linking them takes longer than reading a plain scene
// does. So the functions are in a table, in a shared object of their own, which image_decoder_open links for scenes that
// have images.
#ifndef CANDIL_LOADER_IMAGE_READ_H
#define CANDIL_LOADER_IMAGE_READ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

#define IMAGE_DECODER_FILE "candil-images.so" // beside the loader
#define IMAGE_DECODER_NAME "image_decoder" // the table in it

#ifdef __cplusplus
extern "C" {
#endif

struct image_reader;

struct image_decoder {
	// Recognise an image by its first bytes (png, jpeg; with `any_format` also bmp, tiff, and tga by the ending of
	// `name`) and read its size, 1 … LIMIT_TEXTURE_SIDE a side. `bytes` must outlive the reader, which the caller
	// closes. On failure *reader is NULL.
	enum status (*open)(const uint8_t *bytes, size_t size, const char *name, bool any_format,
			    struct image_reader **reader, uint32_t *width, uint32_t *height, struct error *err);

	// Words that `pixels` needs for a texel, at most: 2 if the file has more than 8 bits a channel, else 1.
	uint32_t (*words)(const struct image_reader *reader);

	// Decode to texels of the caller's, as struct texture_info has them, rows from the top. There is room for width ·
	// height · `words` of them, where `words` is that of the reader or 1. *deep tells whether some channel has a value
	// that 8 bits cannot hold: the texels are deep then if there are two words for each, and else rounded. Grey is
	// converted to RGB, floats to 0 … 1 in 16 bits, and a missing alpha to 1. Colours are not multiplied by alpha.
	enum status (*pixels)(struct image_reader *reader, uint32_t words, uint32_t *texels, bool *deep, struct error *err);

	// As `open`, for an environment map: exr, hdr, tiff, png, jpeg. A file whose pixels do not cover exactly its whole
	// window is refused.
	enum status (*open_surroundings)(const uint8_t *bytes, size_t size, struct image_reader **reader, uint32_t *width,
					 uint32_t *height, struct error *err);

	// Decode to width · height · 3 floats of the caller's, rows from the top. Floats are returned as they are in the
	// file, NaN included. Integers are decoded from sRGB to 0…1, grey becomes RGB, and channels after the third are not
	// read.
	enum status (*radiance)(struct image_reader *reader, float *rgb, struct error *err);

	// Close the reader; NULL is allowed.
	void (*close)(struct image_reader *reader);
};

// The decoder, for those who link it.
extern const struct image_decoder image_decoder;

// The same from IMAGE_DECODER_FILE, which stays linked. Before the sandbox, for it reads files and starts threads. NULL on
// failure: STATUS_INTERNAL, with what the linker says.
const struct image_decoder *image_decoder_open(struct error *err);

#ifdef __cplusplus
}
#endif

#endif
