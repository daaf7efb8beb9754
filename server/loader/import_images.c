// The images of an import, and the textures that use them.
#include <string.h>

#include "server/loader/import.h"
#include "server/loader/import_parts.h"
#include "server/scene/texel.h"

static struct import_image *image_find(const struct import *im, const char *key, bool derived)
{
	for (size_t i = 0; i < im->image_count; i++)
		if (im->images[i].derived == derived && strcmp(im->images[i].key, key) == 0)
			return &im->images[i];
	return NULL;
}

bool import_knows_image(const struct import *im, const char *key)
{
	return image_find(im, key, false) != NULL;
}

bool import_knows_derived(const struct import *im, const char *key)
{
	return image_find(im, key, true) != NULL;
}

struct import_image *import_image_of(struct import *im, uint32_t texture)
{
	size_t i = 0;
	while (im->images[i].width == 0 || im->images[i].offset != im->textures[texture].offset)
		i++;
	return &im->images[i];
}

static enum status image_add(struct import *im, const char *key, const struct import_image *image, struct error *err)
{
	void *items =
	    import_grown(im->images, im->image_count, 1, &im->image_room, sizeof *image, LIMIT_TEXTURES, "images", err);
	if (!items)
		return err->code;
	im->images = items;
	im->images[im->image_count] = *image;
	im->images[im->image_count].key = strdup(key);
	if (!im->images[im->image_count].key)
		return error_set(err, STATUS_MEMORY, "no memory for an image's name");
	im->image_count++;
	return STATUS_OK;
}

enum status import_missing_image(struct import *im, const char *key, const char *why, struct error *err)
{
	const struct import_image none = {0};
	im->info->missing_textures++;
	import_warn(im, "texture '%.60s' is taken as white: %.150s", key, why);
	return image_add(im, key, &none, err);
}

// Round `count` deep texels to 8 bits a channel. `out` may be where they are.
static void round_texels(const uint32_t *deep, size_t count, uint32_t *out)
{
	const struct texture_info from = {.flags = TEXTURE_DEEP}, to = {0};
	for (size_t i = 0; i < count; i++) {
		uint32_t texel = 0;
		for (unsigned c = 0; c < 4; c++)
			texel_put(&to, &texel, 0, c, texel_channel(&from, deep, i, c));
		out[i] = texel;
	}
}

static void tell_rounding(struct import *im)
{
	import_warn(im, "the scene's textures of 16 bits a channel have no room among its %u texels; some are taken in 8",
		    LIMIT_TEXELS);
}

static size_t room_left(const struct import *im)
{
	return LIMIT_TEXELS - im->texel_count;
}

// Round all deep images. What lies behind them, and the textures, follow.
static void round_images(struct import *im)
{
	uint32_t gone = 0;
	for (size_t i = 0; i < im->image_count; i++) { // ascending by their offsets
		struct import_image *image = &im->images[i];
		const uint32_t count = image->width * image->height, offset = image->offset;
		if (count == 0)
			continue;
		uint32_t *from = im->texels + offset, *to = from - gone;
		if (image->deep)
			round_texels(from, count, to);
		else
			memmove(to, from, count * sizeof *to);
		image->offset -= gone;
		for (size_t t = 0; t < im->texture_count; t++)
			if (im->textures[t].offset == offset) {
				im->textures[t].offset = image->offset;
				im->textures[t].flags &= ~TEXTURE_DEEP;
			}
		gone += image->deep ? count : 0;
		image->deep = false;
	}
	im->texel_count -= gone;
	if (gone > 0)
		tell_rounding(im);
}

// Make room for `count` words, if need be by rounding.
static enum status make_texel_room(struct import *im, size_t count, struct error *err)
{
	if (count > room_left(im))
		round_images(im);
	void *items = import_grown(im->texels, im->texel_count, count, &im->texel_room, sizeof *im->texels, LIMIT_TEXELS,
				   "texels", err);
	if (!items)
		return err->code;
	im->texels = items;
	return STATUS_OK;
}

enum status import_expect_images(struct import *im, struct error *err)
{
	if (im->decoder)
		return STATUS_OK;
	im->wants_decoder = true;
	return error_set(err, STATUS_SCENE_UNSUPPORTED, "the scene has images, and nothing decodes them");
}

static enum status image_decode(struct import *im, const char *key, const uint8_t *bytes, size_t size, bool any_format,
				struct error *err)
{
	struct import_image image = {0};
	struct error why;
	struct image_reader *reader = NULL;

	enum status status = import_expect_images(im, err);
	if (status != STATUS_OK)
		return status;
	status = im->decoder->open(bytes, size, key, any_format, &reader, &image.width, &image.height, &why);
	if (status == STATUS_MEMORY)
		return error_set(err, status, "%s", why.text);
	if (status != STATUS_OK)
		return import_missing_image(im, key, why.text, err);
	const size_t count = (size_t)image.width * image.height; // both ≤ LIMIT_TEXTURE_SIDE
	const uint32_t wanted = im->decoder->words(reader), words = count * wanted <= room_left(im) ? wanted : 1;
	if (make_texel_room(im, count * words, err) != STATUS_OK) {
		im->decoder->close(reader);
		return err->code;
	}
	image.offset = (uint32_t)im->texel_count;
	status = im->decoder->pixels(reader, words, im->texels + image.offset, &image.deep, &why);
	im->decoder->close(reader);
	if (status == STATUS_MEMORY)
		return error_set(err, status, "%s", why.text);
	if (status != STATUS_OK)
		return import_missing_image(im, key, why.text, err);
	if (image.deep && words == 1)
		tell_rounding(im);
	image.deep &= words == 2;
	im->texel_count += image.deep ? 2 * count : count;
	return image_add(im, key, &image, err);
}

struct import_sampling import_plain_sampling(uint32_t flags)
{
	return (struct import_sampling){flags, {1, 0, 0}, {0, 1, 0}};
}

// The texture for an image and a sampling. An identical texture is shared.
static enum status texture_over(struct import *im, const struct import_image *image, const struct import_sampling *sampling,
				uint32_t *texture, struct error *err)
{
	const uint32_t flags = sampling->flags | (image->deep ? TEXTURE_DEEP : 0);
	struct texture_info info = {image->offset, image->width, image->height, flags, {0}, {0}};
	memcpy(info.row_u, sampling->row_u, sizeof info.row_u);
	memcpy(info.row_v, sampling->row_v, sizeof info.row_v);
	for (size_t i = 0; i < im->texture_count; i++) {
		if (memcmp(&im->textures[i], &info, sizeof info) == 0) {
			*texture = (uint32_t)i;
			return STATUS_OK;
		}
	}
	void *items = import_grown(im->textures, im->texture_count, 1, &im->texture_room, sizeof info, LIMIT_TEXTURES,
				   "textures", err);
	if (!items)
		return err->code;
	im->textures = items;
	im->textures[im->texture_count] = info;
	*texture = (uint32_t)im->texture_count++;
	return STATUS_OK;
}

enum status import_texture(struct import *im, const char *key, const uint8_t *bytes, size_t size, bool any_format,
			   const struct import_sampling *sampling, uint32_t *texture, struct error *err)
{
	*texture = NONE;
	if (!image_find(im, key, false)) {
		enum status status = image_decode(im, key, bytes, size, any_format, err);
		if (status != STATUS_OK)
			return status;
	}
	const struct import_image *image = image_find(im, key, false);
	return image->width == 0 ? STATUS_OK : texture_over(im, image, sampling, texture, err);
}

enum status import_derived_texture(struct import *im, const char *key, const uint32_t *texels, uint32_t width,
				   uint32_t height, bool deep, const struct import_sampling *sampling, uint32_t *texture,
				   struct error *err)
{
	const size_t count = (size_t)width * height;
	*texture = NONE;
	if (!image_find(im, key, true)) {
		const bool kept = deep && 2 * count <= room_left(im);
		if (make_texel_room(im, kept ? 2 * count : count, err) != STATUS_OK)
			return err->code;
		const struct import_image image = {
		    .derived = true, .deep = kept, .offset = (uint32_t)im->texel_count, .width = width, .height = height};
		uint32_t *to = im->texels + im->texel_count;
		if (deep && !kept) {
			round_texels(texels, count, to);
			tell_rounding(im);
		} else {
			memcpy(to, texels, (kept ? 2 * count : count) * sizeof *to);
		}
		im->texel_count += kept ? 2 * count : count;
		if (image_add(im, key, &image, err) != STATUS_OK)
			return err->code;
	}
	return texture_over(im, image_find(im, key, true), sampling, texture, err);
}
