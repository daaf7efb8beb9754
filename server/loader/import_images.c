// The images of an import, and the textures that use them.
#include <string.h>

#include "server/loader/import.h"
#include "server/loader/import_parts.h"
#include "server/scene/texel.h"

static void image_key(const char *key, bool derived, uint32_t out[IMPORT_IMAGE_WORDS])
{
	_Static_assert(IMPORT_IMAGE_WORDS == KEY_TEXT_WORDS + 1, "a text and whether the image is derived");
	key_of_text(key, out);
	out[KEY_TEXT_WORDS] = derived;
}

static struct import_image *image_find(const struct import *im, const char *key, bool derived)
{
	uint32_t words[IMPORT_IMAGE_WORDS];
	image_key(key, derived, words);
	const uint32_t number = key_table_find(&im->image_keys, words);
	return number == NONE ? NULL : &im->images[number];
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
	return &im->images[im->texture_keys.keys[(size_t)texture * IMPORT_TEXTURE_WORDS]];
}

static enum status image_add(struct import *im, const char *key, const struct import_image *image, struct error *err)
{
	uint32_t words[IMPORT_IMAGE_WORDS], number;
	void *items =
	    import_grown(im->images, im->image_count, 1, &im->image_room, sizeof *image, LIMIT_TEXTURES, "images", err);
	if (!items)
		return err->code;
	im->images = items;
	image_key(key, image->derived, words);
	if (key_table_number(&im->image_keys, words, &number, err) != STATUS_OK)
		return err->code;
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
		const uint32_t count = image->width * image->height;
		if (count == 0)
			continue;
		uint32_t *from = im->texels + image->offset, *to = from - gone;
		if (image->deep)
			round_texels(from, count, to);
		else
			memmove(to, from, count * sizeof *to);
		image->offset -= gone;
		gone += image->deep ? count : 0;
		image->deep = false;
	}
	for (uint32_t t = 0; t < im->texture_count; t++) {
		im->textures[t].offset = import_image_of(im, t)->offset;
		im->textures[t].flags &= ~TEXTURE_DEEP;
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

// Limit what is decoded: many images may be the same bytes of the file, and one that breaks off late leaves no texel that
// would count.
static enum status count_encoded(struct import *im, size_t bytes, struct error *err)
{
	if (bytes > LIMIT_SCENE_SOURCE_BYTES - im->encoded_bytes)
		return error_set(err, STATUS_SCENE_LIMIT, "the scene's images have more than %llu bytes; scale them down",
				 LIMIT_SCENE_SOURCE_BYTES);
	im->encoded_bytes += bytes;
	return STATUS_OK;
}

static enum status count_wasted(struct import *im, size_t texels, struct error *err)
{
	if (texels > LIMIT_TEXELS - im->wasted_texels)
		return error_set(err, STATUS_SCENE_LIMIT,
				 "images of more than %u texels are damaged; mend them or leave them out", LIMIT_TEXELS);
	im->wasted_texels += texels;
	return STATUS_OK;
}

static enum status image_decode(struct import *im, const char *key, const uint8_t *bytes, size_t size, bool any_format,
				struct error *err)
{
	struct import_image image = {0};
	struct error why;
	struct image_reader *reader = NULL;

	if (import_expect_images(im, err) != STATUS_OK || count_encoded(im, size, err) != STATUS_OK)
		return err->code;
	enum status status = im->decoder->open(bytes, size, key, any_format, &reader, &image.width, &image.height, &why);
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
	if (status != STATUS_OK && count_wasted(im, count, err) != STATUS_OK)
		return err->code;
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
	uint32_t key[IMPORT_TEXTURE_WORDS] = {(uint32_t)(image - im->images), sampling->flags};
	_Static_assert(sizeof key == 2 * sizeof *key + sizeof info.row_u + sizeof info.row_v, "image, flags and rows");
	memcpy(key + 2, info.row_u, sizeof info.row_u);
	memcpy(key + 5, info.row_v, sizeof info.row_v);
	*texture = key_table_find(&im->texture_keys, key);
	if (*texture != NONE)
		return STATUS_OK;
	void *items = import_grown(im->textures, im->texture_count, 1, &im->texture_room, sizeof info, LIMIT_TEXTURES,
				   "textures", err);
	if (!items)
		return err->code;
	im->textures = items;
	im->textures[im->texture_count++] = info;
	return key_table_number(&im->texture_keys, key, texture, err);
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
