#include "server/loader/mtl_material.h"

#include <math.h>
#include <stdlib.h>

#include "server/loader/mtl_surface.h"

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
	char *key;
	const enum status status = mtl_map_texture(im, &note->maps[kind], note->folder, flags, &key, texture, err);
	free(key);
	return status;
}

// Turn a bump map into a normal map, unless it already is one.
static enum status normals_of_bumps(struct import *im, const char *name, uint32_t *texture, struct error *err)
{
	const struct texture_info bumps = im->textures[*texture];
	const struct import_sampling sampling = {
	    bumps.flags, {bumps.row_u[0], bumps.row_u[1], bumps.row_u[2]}, {bumps.row_v[0], bumps.row_v[1], bumps.row_v[2]}};
	uint32_t *normals = NULL;

	if (mtl_is_normal_map(im->texels + bumps.offset, bumps.width, bumps.height))
		return STATUS_OK;
	if (!import_knows_derived(im, name) &&
	    mtl_normals_of_heights(im->texels + bumps.offset, bumps.width, bumps.height, &normals, err) != STATUS_OK)
		return err->code;
	enum status status = import_derived_texture(im, name, normals, bumps.width, bumps.height, &sampling, texture, err);
	free(normals);
	return status;
}

static enum status find_normals(struct import *im, const struct mtl_note *note, struct material *out, struct error *err)
{
	char *key;
	const enum mtl_map_kind kind = note->maps[MTL_NORMALS].file ? MTL_NORMALS : MTL_BUMPS;
	const double bump = note->maps[kind].bump;
	if (note->maps[kind].file && isfinite((float)bump))
		out->normal_scale = (float)bump;
	enum status status = mtl_map_texture(im, &note->maps[kind], note->folder, 0, &key, &out->normal_texture, err);
	if (status == STATUS_OK && out->normal_texture != NONE && kind == MTL_BUMPS)
		status = normals_of_bumps(im, key, &out->normal_texture, err);
	free(key);
	return status;
}

static enum status find_maps(struct import *im, const struct mtl_note *note, struct material *out, struct error *err)
{
	if (find_map(im, note, MTL_DIFFUSE, TEXTURE_SRGB, &out->albedo_texture, err) != STATUS_OK ||
	    find_map(im, note, MTL_EMISSION, TEXTURE_SRGB, &out->emission_texture, err) != STATUS_OK)
		return err->code;
	// A lobe without weight needs no texture.
	if (out->specular_weight > 0 &&
	    find_map(im, note, MTL_SPECULAR, TEXTURE_SRGB, &out->specular_texture, err) != STATUS_OK)
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
	return note;
}

static enum status add_material(struct import *im, const struct mtl_note *from, float albedo, struct error *err)
{
	struct material out = import_plain_material(1.0f);
	if (from->folder) {
		const struct mtl_note note = with_defaults(from);
		bool fit = fit_colour(note.diffuse, out.albedo, 1.0);
		fit &= fit_colour(note.emission, out.emission, LIMIT_RADIANCE);
		fit &= mtl_set_surface(im, &note, &out);
		if (find_maps(im, &note, &out, err) != STATUS_OK)
			return err->code;
		if (!fit)
			import_warn(im, "material '%.60s' has a colour out of range, which was clamped", note.name);
	}
	for (int c = 0; c < 3 && !from->has_diffuse && out.transmission == 0; c++)
		out.albedo[c] = out.albedo_texture == NONE ? albedo : 1.0f;
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
