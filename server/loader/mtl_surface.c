#include "server/loader/mtl_surface.h"

#include <math.h>
#include <stdlib.h>

#include "server/scene/texel.h"

float mtl_roughness(double exponent)
{
	const double ns = exponent >= 0 && isfinite(exponent) ? exponent : 0;
	return (float)sqrt(sqrt(2.0 / (ns + 2.0)));
}

// illum 4, 6, 7 and 9 mean glass if some statement says that light is transmitted. A body of index 1 that lets all of it
// through could not be seen: Maya writes illum 4, Ni 1 and Tf 1 1 1 of opaque surfaces.
static bool is_glass(const struct mtl_note *note)
{
	const double *f = note->filter;
	if (note->ior == 1 && (!note->has_filter || (f[0] == 1 && f[1] == 1 && f[2] == 1)))
		return false;
	const bool clear = note->illum == 4 || note->illum == 6 || note->illum == 7 || note->illum == 9;
	const bool passes = f[0] > 0 || f[1] > 0 || f[2] > 0;
	return clear && (note->has_filter ? passes : note->ior > 0 || note->dissolve < 1);
}

// Solid glass, smooth unless Pr is given. Tf is the transmittance of a whole body, so each of its two faces takes the
// square root.
static bool set_glass(const struct mtl_note *note, struct material *m)
{
	const double ior = note->ior > 0 ? note->ior : 1.5;
	bool fit = import_fit(&m->ior, ior, LIMIT_IOR_MOST) && ior >= LIMIT_IOR_LEAST;
	m->ior = fmaxf(m->ior, (float)LIMIT_IOR_LEAST);
	m->transmission = 1;
	float priority;
	fit &= import_fit(&priority, note->priority, LIMIT_PRIORITY) && floorf(priority) == priority;
	m->flags |= (uint32_t)priority << MATERIAL_PRIORITY_SHIFT;
	fit &= import_fit(&m->roughness, note->has_roughness ? note->roughness : 0, 1.0);
	m->specular_weight = 1;
	const float f0 = (m->ior - 1) / (m->ior + 1) * ((m->ior - 1) / (m->ior + 1));
	for (int c = 0; c < 3; c++) {
		m->specular[c] = f0;
		fit &= import_fit(&m->albedo[c], note->has_filter ? note->filter[c] : 1.0, 1.0);
		m->albedo[c] = sqrtf(m->albedo[c]);
	}
	return fit;
}

static bool set_dissolve(const struct mtl_note *note, struct material *m)
{
	const bool fit = import_fit(&m->alpha, note->dissolve, 1.0);
	if (m->alpha < 1)
		m->flags |= MATERIAL_ALPHA_BLEND;
	return fit;
}

static bool is_physical(const struct mtl_note *note)
{
	return note->has_roughness || note->has_metallic;
}

// Set up glTF's metallic-roughness material.
static bool set_physical(const struct mtl_note *note, struct material *m)
{
	const double ior = note->ior > 0 ? note->ior : 1.5;
	const double f0 = (ior - 1) / (ior + 1) * ((ior - 1) / (ior + 1));
	const double own = note->has_exponent ? (double)mtl_roughness(note->exponent) : 1;
	bool fit = import_fit(&m->metallic, note->metallic, 1.0);
	fit &= import_fit(&m->roughness, note->has_roughness ? note->roughness : own, 1.0);
	m->specular_weight = 1;
	for (int c = 0; c < 3; c++)
		fit &= import_fit(&m->specular[c], f0, 1.0);
	return fit;
}

// Set up the lobe of Ks and Ns.
static bool set_highlight(const struct mtl_note *note, struct material *m)
{
	const bool mirror = note->illum == 3 || note->illum == 5 || note->illum == 8;
	bool fit = true;
	m->roughness = mirror && !note->has_exponent ? 0 : mtl_roughness(note->exponent);
	for (int c = 0; c < 3; c++) {
		fit &= import_fit(&m->specular[c], note->specular[c], 1.0);
		m->specular_weight = fmaxf(m->specular_weight, m->specular[c]);
	}
	if (note->illum == 5 && m->specular_weight > 0)
		m->specular_weight = 1;
	return fit;
}

// Set up the clear coat and the roughness of the diffuse part.
static bool set_layers(const struct mtl_note *note, struct material *m)
{
	bool fit = import_fit(&m->coat, note->coat, 1.0);
	fit &= import_fit(&m->coat_roughness, note->coat_roughness, 1.0);
	return import_fit(&m->diffuse_roughness, note->diffuse_roughness, 1.0) && fit;
}

// Note statements as ignored that only glass uses, on other surfaces, and the reverse. Many exporters write Ni and Tf of
// every material; MTL itself has no use for them where nothing is refracted.
static void tell_ignored(struct import *im, const struct mtl_note *note, bool glass)
{
	const double *f = note->filter;
	if (note->illum == 10)
		import_ignore(im, "illum 10");
	if (!glass && !is_physical(note) && note->ior > 0 && note->ior != 1)
		import_pass_over(im, "Ni");
	if (!glass && note->has_filter && (f[0] != 1 || f[1] != 1 || f[2] != 1))
		import_pass_over(im, "Tf");
	if (!glass && note->priority > 0)
		import_ignore(im, "Pp");
	if (glass && note->dissolve != 1)
		import_ignore(im, "d");
	if (glass && note->maps[MTL_DISSOLVE].file)
		import_ignore(im, "map_d");
	if (glass && note->coat > 0)
		import_ignore(im, "Pc");
}

bool mtl_set_surface(struct import *im, const struct mtl_note *note, struct material *m)
{
	const double *ks = note->specular;
	const bool says = ks[0] > 0 || ks[1] > 0 || ks[2] > 0;
	const bool glossy = note->illum >= 2 || (note->illum < 0 && says && note->exponent > 0);
	const bool glass = is_glass(note);
	tell_ignored(im, note, glass);
	if (glass)
		return set_glass(note, m);
	bool fit = set_dissolve(note, m);
	fit &= set_layers(note, m);
	if (is_physical(note))
		return set_physical(note, m) && fit;
	return (!glossy || set_highlight(note, m)) && fit;
}

bool mtl_is_normal_map(const struct texture_info *texture, const uint32_t *texels)
{
	const size_t count = (size_t)texture->width * texture->height;
	uint64_t sum[3] = {0, 0, 0};
	for (size_t i = 0; i < count; i++)
		for (unsigned c = 0; c < 3; c++)
			sum[c] += texel_channel(texture, texels, i, c);
	double mean[3];
	for (int c = 0; c < 3; c++)
		mean[c] = (double)sum[c] / (65535.0 * (double)count);
	return fabs(mean[0] - 0.5) < 0.1 && fabs(mean[1] - 0.5) < 0.1 && mean[2] > 0.75;
}

static double height_at(const struct texture_info *t, const uint32_t *texels, uint32_t x, uint32_t y)
{
	const size_t i = (size_t)y * t->width + x;
	return (texel_channel(t, texels, i, 0) + texel_channel(t, texels, i, 1) + texel_channel(t, texels, i, 2)) / 196605.0;
}

static uint32_t encoded(double component, double most)
{
	return (uint32_t)lround((component * 0.5 + 0.5) * most);
}

// Store a unit vector as the texel `i`.
static void put_normal(uint32_t *texels, size_t i, bool deep, double x, double y, double z)
{
	if (deep) {
		texels[2 * i] = encoded(x, 65535) | encoded(y, 65535) << 16;
		texels[2 * i + 1] = encoded(z, 65535) | 65535u << 16;
	} else {
		texels[i] = encoded(x, 255) | encoded(y, 255) << 8 | encoded(z, 255) << 16 | 255u << 24;
	}
}

enum status mtl_normals_of_heights(const struct texture_info *t, const uint32_t *texels, uint32_t **out, struct error *err)
{
	const uint32_t width = t->width, height = t->height; // both ≤ LIMIT_TEXTURE_SIDE
	*out = malloc((size_t)width * height * texel_words(t) * sizeof **out);
	if (!*out)
		return error_set(err, STATUS_MEMORY, "no memory for a normal map of %u x %u", width, height);
	for (uint32_t y = 0; y < height; y++)
		for (uint32_t x = 0; x < width; x++) {
			const uint32_t left = (x + width - 1) % width, right = (x + 1) % width;
			const uint32_t above = (y + height - 1) % height, below = (y + 1) % height;
			const double dx = 0.5 * (height_at(t, texels, right, y) - height_at(t, texels, left, y));
			const double dy = 0.5 * (height_at(t, texels, x, above) - height_at(t, texels, x, below));
			const double scale = 1 / sqrt(dx * dx + dy * dy + 1);
			put_normal(*out, (size_t)y * width + x, t->flags & TEXTURE_DEEP, -dx * scale, -dy * scale, scale);
		}
	return STATUS_OK;
}
