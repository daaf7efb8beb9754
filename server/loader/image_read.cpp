extern "C" {
#include "server/loader/image_read.h"
}

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <strings.h>
#include <vector>

// OpenImageIO's PNG reader leaves by longjmp if a file is truncated, and thereby skips its own destructors.
#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
typedef __lsan::ScopedDisabler ignore_leaks;
#else
struct ignore_leaks {
	~ignore_leaks()
	{
	}
};
#endif

namespace
{

bool starts_with(const uint8_t *bytes, size_t size, const char *magic, size_t length)
{
	return size >= length && std::memcmp(bytes, magic, length) == 0;
}

bool ends_with(const std::string &text, const char *ending)
{
	const size_t length = std::strlen(ending);
	return text.size() >= length && strcasecmp(text.c_str() + text.size() - length, ending) == 0;
}

// A file name that makes OpenImageIO choose the right reader; null for formats that are not read here.
const char *format_of(const uint8_t *bytes, size_t size, const char *name, bool any_format)
{
	if (starts_with(bytes, size, "\x89PNG\r\n\x1a\n", 8))
		return "image.png";
	if (starts_with(bytes, size, "\xff\xd8\xff", 3))
		return "image.jpg";
	if (!any_format)
		return nullptr;
	if (starts_with(bytes, size, "BM", 2))
		return "image.bmp";
	if (starts_with(bytes, size, "II*\0", 4) || starts_with(bytes, size, "MM\0*", 4))
		return "image.tif";
	return ends_with(name, ".tga") ? "image.tga" : nullptr;
}

// As format_of, for environment maps.
const char *surroundings_of(const uint8_t *bytes, size_t size)
{
	if (starts_with(bytes, size, "\x76\x2f\x31\x01", 4))
		return "image.exr";
	if (starts_with(bytes, size, "#?RADIANCE", 10) || starts_with(bytes, size, "#?RGBE", 6))
		return "image.hdr";
	if (starts_with(bytes, size, "II*\0", 4) || starts_with(bytes, size, "MM\0*", 4))
		return "image.tif";
	return format_of(bytes, size, "", false);
}

} // namespace

struct image_reader {
	OIIO::Filesystem::IOMemReader memory;
	std::unique_ptr<OIIO::ImageInput> input;

	image_reader(const uint8_t *bytes, size_t size) : memory(const_cast<uint8_t *>(bytes), size)
	{
	}
};

static enum status open_input(image_reader *reader, const char *format, uint32_t *width, uint32_t *height, struct error *err)
{
	OIIO::ImageSpec config;
	config.attribute("oiio:UnassociatedAlpha", 1);
	OIIO::Filesystem::IOProxy *proxy = &reader->memory;
	config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy); // without it, `config` would hide the proxy
	reader->input = OIIO::ImageInput::open(format, &config, &reader->memory);
	if (!reader->input) {
		std::string why = OIIO::geterror();
		return error_set(err, STATUS_SCENE_INVALID, "the image cannot be read (%.120s)", why.c_str());
	}
	const OIIO::ImageSpec &spec = reader->input->spec();
	if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1 || spec.nchannels > 64)
		return error_set(err, STATUS_SCENE_INVALID, "the image has no pixels");
	if (spec.width > (int)LIMIT_TEXTURE_SIDE || spec.height > (int)LIMIT_TEXTURE_SIDE)
		return error_set(err, STATUS_SCENE_LIMIT, "the image has %d x %d pixels; a side may have %u", spec.width,
				 spec.height, LIMIT_TEXTURE_SIDE);
	*width = (uint32_t)spec.width;
	*height = (uint32_t)spec.height;
	return STATUS_OK;
}

static enum status no_memory(struct error *err)
{
	return error_set(err, STATUS_MEMORY, "no memory to decode an image");
}

// `format` is null if the bytes are in none of the formats that `kinds` lists.
static enum status open_as(const uint8_t *bytes, size_t size, const char *format, const char *kinds,
			   struct image_reader **reader, uint32_t *width, uint32_t *height, struct error *err)
{
	*reader = nullptr;
	*width = *height = 0;
	if (!format)
		return error_set(err, STATUS_SCENE_UNSUPPORTED, "it is no %s file", kinds);
	try {
		OIIO::attribute("threads", 1);
		OIIO::attribute("exr_threads", -1);
		auto made = std::make_unique<image_reader>(bytes, size);
		enum status status = open_input(made.get(), format, width, height, err);
		if (status == STATUS_OK)
			*reader = made.release();
		else
			*width = *height = 0;
		return status;
	} catch (const std::bad_alloc &) {
		*width = *height = 0;
		return no_memory(err);
	} catch (const std::exception &e) {
		*width = *height = 0;
		return error_set(err, STATUS_SCENE_INVALID, "the image cannot be read (%.120s)", e.what());
	}
}

static enum status open_image(const uint8_t *bytes, size_t size, const char *name, bool any_format,
			      struct image_reader **reader, uint32_t *width, uint32_t *height, struct error *err)
{
	return open_as(bytes, size, format_of(bytes, size, name, any_format),
		       any_format ? "png, jpeg, tga, bmp or tiff" : "png or jpeg", reader, width, height, err);
}

static void close_image(struct image_reader *reader)
{
	delete reader;
}

static enum status open_surroundings(const uint8_t *bytes, size_t size, struct image_reader **reader, uint32_t *width,
				     uint32_t *height, struct error *err)
{
	enum status status =
	    open_as(bytes, size, surroundings_of(bytes, size), "exr, hdr, tiff, png or jpeg", reader, width, height, err);
	if (status != STATUS_OK)
		return status;
	const OIIO::ImageSpec &spec = (*reader)->input->spec();
	if (spec.width == spec.full_width && spec.height == spec.full_height && spec.x == spec.full_x &&
	    spec.y == spec.full_y)
		return STATUS_OK;
	close_image(*reader);
	*reader = nullptr;
	return error_set(err, STATUS_SCENE_UNSUPPORTED,
			 "its pixels fill another window than the picture's: crop or extend it to all directions");
}

// Convert pixels of `channels` values each to texels, of two words if `deep`. `one` is the value of full alpha.
template <typename value>
static void pack(const std::vector<value> &pixels, int channels, value one, bool deep, uint32_t *texels)
{
	const size_t step = (size_t)channels, count = pixels.size() / step;
	const int bits = deep ? 16 : 8;
	for (size_t i = 0; i < count; i++) {
		const value *p = &pixels[i * step];
		const uint32_t r = p[0];
		const uint32_t g = channels >= 3 ? p[1] : r;
		const uint32_t b = channels >= 3 ? p[2] : r;
		const uint32_t a = channels == 2 ? p[1] : channels >= 4 ? p[3] : one;
		if (deep) {
			texels[2 * i] = r | g << bits;
			texels[2 * i + 1] = b | a << bits;
		} else {
			texels[i] = r | g << bits | b << 2 * bits | a << 3 * bits;
		}
	}
}

static bool has_deep_channels(const image_reader *reader)
{
	return reader->input->spec().format.size() > 1;
}

static uint32_t image_words(const struct image_reader *reader)
{
	return has_deep_channels(reader) ? 2 : 1;
}

static enum status read_pixels(image_reader *reader, int channels, OIIO::TypeDesc type, void *pixels, struct error *err)
{
	if (reader->input->read_image(0, 0, 0, channels, type, pixels))
		return STATUS_OK;
	std::string why = reader->input->geterror();
	return error_set(err, STATUS_SCENE_INVALID, "the image is damaged (%.120s)", why.c_str());
}

// Files often have 8 bits a channel in 16, as 257 times their value. They are kept as 8, without loss.
static enum status deep_pixels(image_reader *reader, int channels, std::vector<uint16_t> &pixels, uint32_t words,
			       uint32_t *texels, bool *deep, struct error *err)
{
	enum status status = read_pixels(reader, channels, OIIO::TypeDesc::UINT16, pixels.data(), err);
	if (status != STATUS_OK)
		return status;
	*deep = std::any_of(pixels.begin(), pixels.end(), [](uint16_t v) { return v % 257 != 0; });
	const bool kept = *deep && words == 2;
	if (!kept)
		std::transform(pixels.begin(), pixels.end(), pixels.begin(),
			       [](uint16_t v) { return (uint16_t)((v + 128) / 257); });
	pack<uint16_t>(pixels, channels, kept ? 65535 : 255, kept, texels);
	return STATUS_OK;
}

static enum status image_pixels(struct image_reader *reader, uint32_t words, uint32_t *texels, bool *deep, struct error *err)
{
	*deep = false;
	try {
		ignore_leaks here;
		const OIIO::ImageSpec spec = reader->input->spec();
		const int channels = std::min(spec.nchannels, 4);
		const size_t values = (size_t)spec.width * (size_t)spec.height * (size_t)channels;
		if (has_deep_channels(reader)) {
			std::vector<uint16_t> pixels(values);
			return deep_pixels(reader, channels, pixels, words, texels, deep, err);
		}
		std::vector<uint8_t> pixels(values);
		enum status status = read_pixels(reader, channels, OIIO::TypeDesc::UINT8, pixels.data(), err);
		if (status == STATUS_OK)
			pack<uint8_t>(pixels, channels, 255, false, texels);
		return status;
	} catch (const std::bad_alloc &) {
		return no_memory(err);
	} catch (const std::exception &e) {
		return error_set(err, STATUS_SCENE_INVALID, "the image is damaged (%.120s)", e.what());
	}
}

// The sRGB transfer function, IEC 61966-2-1.
static float linear(float v)
{
	return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

static enum status image_radiance(struct image_reader *reader, float *rgb, struct error *err)
{
	try {
		ignore_leaks here;
		const OIIO::ImageSpec spec = reader->input->spec();
		const size_t count = (size_t)spec.width * (size_t)spec.height;
		const int channels = spec.nchannels >= 3 ? 3 : 1;
		if (!reader->input->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, rgb)) {
			std::string why = reader->input->geterror();
			return error_set(err, STATUS_SCENE_INVALID, "the image is damaged (%.120s)", why.c_str());
		}
		// From the last value on, so that no grey value is overwritten before it is copied.
		for (size_t i = count; i-- > 0 && channels == 1;)
			rgb[3 * i] = rgb[3 * i + 1] = rgb[3 * i + 2] = rgb[i];
		if (!spec.format.is_floating_point())
			std::transform(rgb, rgb + 3 * count, rgb, linear);
		return STATUS_OK;
	} catch (const std::bad_alloc &) {
		return no_memory(err);
	} catch (const std::exception &e) {
		return error_set(err, STATUS_SCENE_INVALID, "the image is damaged (%.120s)", e.what());
	}
}

const struct image_decoder image_decoder = {
    .open = open_image,
    .words = image_words,
    .pixels = image_pixels,
    .open_surroundings = open_surroundings,
    .radiance = image_radiance,
    .close = close_image,
};
