// The images of an import, and the textures that use them.
#include <string.h>

#include "server/loader/image_read.h"
#include "server/loader/import.h"
#include "server/loader/import_parts.h"

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

static enum status make_texel_room(struct import *im, size_t count, struct error *err)
{
	void *items = import_grown(im->texels, im->texel_count, count, &im->texel_room, sizeof *im->texels, LIMIT_TEXELS,
				   "texels", err);
	if (!items)
		return err->code;
	im->texels = items;
	return STATUS_OK;
}

static enum status image_decode(struct import *im, const char *key, const uint8_t *bytes, size_t size, bool any_format,
				struct error *err)
{
	struct import_image image = {.offset = (uint32_t)im->texel_count};
	struct error why;
	struct image_reader *reader = NULL;

	enum status status = image_open(bytes, size, key, any_format, &reader, &image.width, &image.height, &why);
	if (status == STATUS_MEMORY)
		return error_set(err, status, "%s", why.text);
	if (status != STATUS_OK)
		return import_missing_image(im, key, why.text, err);
	const size_t count = (size_t)image.width * image.height; // both ≤ LIMIT_TEXTURE_SIDE
	if (make_texel_room(im, count * image_words(reader), err) != STATUS_OK) {
		image_close(reader);
		return err->code;
	}
	status = image_pixels(reader, im->texels + im->texel_count, &image.deep, &why);
	image_close(reader);
	if (status == STATUS_MEMORY)
		return error_set(err, status, "%s", why.text);
	if (status != STATUS_OK)
		return import_missing_image(im, key, why.text, err);
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
	const size_t count = (size_t)width * height * (deep ? 2 : 1);
	*texture = NONE;
	if (!image_find(im, key, true)) {
		const struct import_image image = {
		    .derived = true, .deep = deep, .offset = (uint32_t)im->texel_count, .width = width, .height = height};
		if (make_texel_room(im, count, err) != STATUS_OK)
			return err->code;
		memcpy(im->texels + im->texel_count, texels, count * sizeof *texels);
		im->texel_count += count;
		if (image_add(im, key, &image, err) != STATUS_OK)
			return err->code;
	}
	return texture_over(im, image_find(im, key, true), sampling, texture, err);
}
