#include "server/loader/mtl_material.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/loader/mtl_surface.h"
#include "server/scene/texel.h"

static bool fit_colour(const double from[3], float out[3], double limit)
{
	bool fit = true;
	for (int c = 0; c < 3; c++)
		fit &= import_fit(&out[c], from[c], limit);
	return fit;
}

static enum status find_map(struct import *im, const struct mtl_note *note, enum mtl_map_kind kind, uint32_t flags,
			    uint32_t *texture, struct error *err)
{
	const char *key;
	if (note->maps[kind].file && note->maps[kind].channel && kind < MTL_DISSOLVE)
		import_ignore(im, "map option -imfchan");
	return mtl_map_texture(im, &note->maps[kind], note->folder, flags, &key, texture, err);
}

// Turn a bump map into a normal map, unless it already is one.
static enum status normals_of_bumps(struct import *im, const char *name, uint32_t *texture, struct error *err)
{
	const struct texture_info bumps = im->textures[*texture];
	const struct import_sampling sampling = {bumps.flags & ~TEXTURE_DEEP,
						 {bumps.row_u[0], bumps.row_u[1], bumps.row_u[2]},
						 {bumps.row_v[0], bumps.row_v[1], bumps.row_v[2]}};
	uint32_t *normals = NULL;

	struct import_image *image = import_image_of(im, *texture);
	if (image->has_normals == 0)
		image->has_normals = mtl_is_normal_map(&bumps, im->texels) ? 1 : -1;
	if (image->has_normals > 0)
		return STATUS_OK;
	if (!import_knows_derived(im, name) && mtl_normals_of_heights(&bumps, im->texels, &normals, err) != STATUS_OK)
		return err->code;
	enum status status = import_derived_texture(im, name, normals, bumps.width, bumps.height, bumps.flags & TEXTURE_DEEP,
						    &sampling, texture, err);
	free(normals);
	return status;
}

static enum status find_normals(struct import *im, const struct mtl_note *note, struct material *out, struct error *err)
{
	const char *key;
	const enum mtl_map_kind kind = note->maps[MTL_NORMALS].file ? MTL_NORMALS : MTL_BUMPS;
	const double bump = note->maps[kind].bump;
	const char channel = note->maps[kind].channel;
	if (note->maps[kind].file && channel && channel != 'l')
		import_ignore(im, "map option -imfchan");
	if (note->maps[kind].file && isfinite((float)bump))
		out->normal_scale = (float)bump;
	enum status status = mtl_map_texture(im, &note->maps[kind], note->folder, 0, &key, &out->normal_texture, err);
	if (status == STATUS_OK && out->normal_texture != NONE && kind == MTL_BUMPS)
		status = normals_of_bumps(im, key, &out->normal_texture, err);
	return status;
}

// A number of each texel, the channel that -imfchan names. Without, it is the alpha of a picture that has one, else the
// brightness.
struct scalar_map {
	uint32_t texture; // NONE: there is no map
	char channel;
};

static bool has_alpha(struct import *im, uint32_t texture)
{
	const struct texture_info *t = &im->textures[texture];
	struct import_image *image = import_image_of(im, texture);
	if (image->has_alpha == 0) {
		image->has_alpha = -1;
		for (size_t i = 0; i < (size_t)t->width * t->height && image->has_alpha < 0; i++)
			if (texel_channel(t, im->texels, i, 3) < TEXEL_WHITE)
				image->has_alpha = 1;
	}
	return image->has_alpha > 0;
}

static enum status find_scalar(struct import *im, const struct mtl_note *note, enum mtl_map_kind kind,
			       struct scalar_map *map, struct error *err)
{
	map->channel = note->maps[kind].channel;
	const enum status status = find_map(im, note, kind, 0, &map->texture, err);
	if (status != STATUS_OK || map->texture == NONE || map->channel)
		return status;
	if (kind == MTL_DISSOLVE && has_alpha(im, map->texture))
		map->channel = 'm';
	return STATUS_OK;
}

// The number of texel `i`, 0 … TEXEL_WHITE.
static uint32_t scalar_of(const struct import *im, const struct scalar_map *map, size_t i)
{
	if (map->texture == NONE)
		return TEXEL_WHITE;
	const struct texture_info *t = &im->textures[map->texture];
	const uint32_t red = texel_channel(t, im->texels, i, 0), green = texel_channel(t, im->texels, i, 1);
	const uint32_t blue = texel_channel(t, im->texels, i, 2);
	switch (map->channel) {
	case 'r':
		return red;
	case 'g':
		return green;
	case 'b':
		return blue;
	case 'm':
		return texel_channel(t, im->texels, i, 3);
	default:
		return (red + green + blue + 1) / 3;
	}
}

// Whether two textures show their texels at the same places.
static bool are_alike(const struct texture_info *a, const struct texture_info *b)
{
	return a->width == b->width && a->height == b->height &&
	       ((a->flags ^ b->flags) & ~(TEXTURE_SRGB | TEXTURE_DEEP)) == 0 &&
	       memcmp(a->row_u, b->row_u, sizeof a->row_u) == 0 && memcmp(a->row_v, b->row_v, sizeof a->row_v) == 0;
}

// The texels of put_scalars, in the caller's room: `texture` says of which size and depth.
static void fill_scalars(const struct import *im, uint32_t base, const struct scalar_map *maps, unsigned first,
			 unsigned count, const struct texture_info *texture, uint32_t *texels)
{
	for (size_t i = 0; i < (size_t)texture->width * texture->height; i++)
		for (unsigned c = 0; c < 4; c++) {
			uint32_t number = TEXEL_WHITE;
			if (c >= first && c < first + count)
				number = scalar_of(im, &maps[c - first], i);
			else if (base != NONE)
				number = texel_channel(&im->textures[base], im->texels, i, c);
			texel_put(texture, texels, i, c, number);
		}
}

// The number of the image that a texture shows, NONE of none.
static uint32_t image_number(struct import *im, uint32_t texture)
{
	return texture == NONE ? NONE : (uint32_t)(import_image_of(im, texture) - im->images);
}

// Make one texture of the colours of *texture (NONE: white) and of numbers in the place of channels `first` and on: two maps
// at most, of which one may be missing. *texture becomes that one, deep if any of them is. False: the maps differ in size or
// place.
static enum status put_scalars(struct import *im, uint32_t *texture, const struct scalar_map *maps, unsigned first,
			       unsigned count, uint32_t flags, bool *done, struct error *err)
{
	const uint32_t base = *texture;
	uint32_t like = base, deep = base == NONE ? 0 : im->textures[base].flags & TEXTURE_DEEP;
	char key[128] = "";
	*done = true;
	for (unsigned i = 0; i < count; i++) {
		const uint32_t at = maps[i].texture;
		like = like == NONE ? at : like;
		deep |= at == NONE ? 0 : im->textures[at].flags & TEXTURE_DEEP;
		*done = *done && (at == NONE || are_alike(&im->textures[at], &im->textures[like]));
	}
	if (like == NONE || !*done)
		return STATUS_OK;
	// A name that no file can have: it holds line breaks. It names images, which textures of several places share.
	for (unsigned i = 0; i < count; i++)
		snprintf(key + strlen(key), sizeof key - strlen(key), "\n%u %u %c", first + i,
			 image_number(im, maps[i].texture), maps[i].channel ? maps[i].channel : ' ');
	snprintf(key + strlen(key), sizeof key - strlen(key), "\n%u", image_number(im, base));
	struct texture_info t = im->textures[like];
	const struct import_sampling sampling = {(t.flags & ~(TEXTURE_SRGB | TEXTURE_DEEP)) | flags,
						 {t.row_u[0], t.row_u[1], t.row_u[2]},
						 {t.row_v[0], t.row_v[1], t.row_v[2]}};
	t.flags = deep;
	t.offset = 0;
	uint32_t *out = NULL;
	if (!import_knows_derived(im, key)) {
		out = calloc((size_t)t.width * t.height, texel_words(&t) * sizeof *out); // both ≤ LIMIT_TEXTURE_SIDE
		if (!out)
			return error_set(err, STATUS_MEMORY, "no memory for a map of %u x %u", t.width, t.height);
		fill_scalars(im, base, maps, first, count, &t, out);
	}
	enum status status = import_derived_texture(im, key, out, t.width, t.height, deep != 0, &sampling, texture, err);
	free(out);
	return status;
}

// map_d: the alpha of the base colour.
static enum status find_alpha(struct import *im, const struct mtl_note *note, struct material *out, struct error *err)
{
	struct scalar_map map;
	bool done;
	if (out->transmission > 0)
		return STATUS_OK;
	const enum status status = find_scalar(im, note, MTL_DISSOLVE, &map, err);
	if (status != STATUS_OK || map.texture == NONE)
		return status;
	if (put_scalars(im, &out->albedo_texture, &map, 3, 1, TEXTURE_SRGB, &done, err) != STATUS_OK)
		return err->code;
	if (done)
		out->flags |= MATERIAL_ALPHA_BLEND;
	else
		import_ignore(im, "map_d of another size or place than map_Kd");
	return STATUS_OK;
}

// map_Pr and map_Pm: green and blue of one texture.
static enum status find_facets(struct import *im, const struct mtl_note *note, struct material *out, struct error *err)
{
	struct scalar_map maps[2];
	bool done;
	if (find_scalar(im, note, MTL_ROUGHNESS, &maps[0], err) != STATUS_OK ||
	    find_scalar(im, note, MTL_METALLIC, &maps[1], err) != STATUS_OK ||
	    put_scalars(im, &out->surface_texture, maps, 1, 2, 0, &done, err) != STATUS_OK)
		return err->code;
	if (!done)
		import_ignore(im, "map_Pm of another size or place than map_Pr");
	maps[1].texture = NONE;
	return done ? STATUS_OK : put_scalars(im, &out->surface_texture, maps, 1, 2, 0, &done, err);
}

// The base colour. Without Kd it is the default, but what map_Kd shows is taken whole.
static enum status find_albedo(struct import *im, const struct mtl_note *note, float albedo, struct material *out,
			       struct error *err)
{
	if (find_map(im, note, MTL_DIFFUSE, TEXTURE_SRGB, &out->albedo_texture, err) != STATUS_OK)
		return err->code;
	for (int c = 0; c < 3 && !note->has_diffuse && out->transmission == 0; c++)
		out->albedo[c] = out->albedo_texture == NONE ? albedo : 1.0f;
	return STATUS_OK;
}

static enum status find_maps(struct import *im, const struct mtl_note *note, float albedo, struct material *out,
			     struct error *err)
{
	if (find_albedo(im, note, albedo, out, err) != STATUS_OK ||
	    find_map(im, note, MTL_EMISSION, TEXTURE_SRGB, &out->emission_texture, err) != STATUS_OK)
		return err->code;
	// A lobe without weight needs no texture.
	if (out->specular_weight > 0 &&
	    find_map(im, note, MTL_SPECULAR, TEXTURE_SRGB, &out->specular_texture, err) != STATUS_OK)
		return err->code;
	if (find_alpha(im, note, out, err) != STATUS_OK || find_facets(im, note, out, err) != STATUS_OK)
		return err->code;
	return find_normals(im, note, out, err);
}

// A map alone, without its colour, is taken whole.
static struct mtl_note with_defaults(const struct mtl_note *from)
{
	struct mtl_note note = *from;
	for (int c = 0; c < 3; c++) {
		if (!note.has_emission && note.maps[MTL_EMISSION].file)
			note.emission[c] = 1;
		if (!note.has_specular && note.maps[MTL_SPECULAR].file)
			note.specular[c] = 1;
	}
	if (!note.has_roughness && note.maps[MTL_ROUGHNESS].file)
		note.roughness = note.has_roughness = 1;
	if (!note.has_metallic && note.maps[MTL_METALLIC].file)
		note.metallic = note.has_metallic = 1;
	return note;
}

static enum status add_material(struct import *im, const struct mtl_note *from, float albedo, struct error *err)
{
	struct material out = import_plain_material(albedo);
	if (from->folder) {
		const struct mtl_note note = with_defaults(from);
		bool fit = fit_colour(note.diffuse, out.albedo, 1.0);
		fit &= fit_colour(note.emission, out.emission, LIMIT_RADIANCE);
		fit &= mtl_set_surface(im, &note, &out);
		if (find_maps(im, &note, albedo, &out, err) != STATUS_OK)
			return err->code;
		if (!fit)
			import_warn(im, "material '%.60s' has a colour out of range, which was clamped", note.name);
	}
	return import_add_material(im, &out, from->name[0] ? from->name : "default", err);
}

enum status mtl_materials_add(struct import *im, const struct mtl_notes *notes, float albedo, struct error *err)
{
	const char *taken_as = albedo < 1 ? "grey" : "white";
	for (size_t i = 0; i < notes->count; i++) {
		const struct mtl_note *note = &notes->notes[i];
		if (add_material(im, note, albedo, err) != STATUS_OK)
			return err->code;
		if (note->is_used && !note->name[0] && !note->folder)
			import_warn(im, "surfaces without a material are taken as %s", taken_as);
		else if (note->is_used && !note->folder)
			import_warn(im, "material '%.60s' is not defined by an MTL file and is taken as %s", note->name,
				    taken_as);
	}
	return STATUS_OK;
}
