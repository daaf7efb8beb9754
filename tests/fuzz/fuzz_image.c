// A hostile image: a texture of a glTF (first byte 0), one of an MTL of any format (1 … 3, by the ending of its name), or a
// picture of the surroundings (any other).
#include <stdlib.h>

#include "server/loader/image_read.h"

#define DECODED_TEXELS 65536u // of one that is larger nothing but its header is read

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

// Where a library of a format gives up, what it was about to fill in is lost. The loader reads one scene and ends.
const char *__asan_default_options(void);

const char *__asan_default_options(void)
{
	return "detect_leaks=0";
}

static void texture(const uint8_t *data, size_t size, const char *name, bool any_format)
{
	struct image_reader *reader;
	uint32_t width, height;
	struct error err;
	bool deep;
	if (image_decoder.open(data, size, name, any_format, &reader, &width, &height, &err) != STATUS_OK)
		return;
	const uint32_t words = image_decoder.words(reader);
	if ((uint64_t)width * height <= DECODED_TEXELS) {
		uint32_t *texels = malloc((size_t)width * height * words * sizeof *texels);
		if (texels)
			image_decoder.pixels(reader, words, texels, &deep, &err);
		free(texels);
	}
	image_decoder.close(reader);
}

static void surroundings(const uint8_t *data, size_t size)
{
	struct image_reader *reader;
	uint32_t width, height;
	struct error err;
	if (image_decoder.open_surroundings(data, size, &reader, &width, &height, &err) != STATUS_OK)
		return;
	if ((uint64_t)width * height <= DECODED_TEXELS) {
		float *rgb = malloc((size_t)width * height * 3 * sizeof *rgb);
		if (rgb)
			image_decoder.radiance(reader, rgb, &err);
		free(rgb);
	}
	image_decoder.close(reader);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const char *const names[] = {"map.png", "map.bmp", "map.tga", "map.tif"};
	if (size == 0)
		return 0;
	if (data[0] < 4)
		texture(data + 1, size - 1, names[data[0]], data[0] > 0);
	else
		surroundings(data + 1, size - 1);
	return 0;
}
