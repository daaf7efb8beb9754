#include "server/loader/mtl_surface.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

float mtl_roughness(double exponent)
{
	const double ns = exponent >= 0 && isfinite(exponent) ? exponent : 0;
	return (float)sqrt(sqrt(2.0 / (ns + 2.0)));
}

bool mtl_set_surface(struct import *im, const struct mtl_note *note, struct material *m)
{
	const double *ks = note->specular;
	const bool says = ks[0] > 0 || ks[1] > 0 || ks[2] > 0;
	const bool glossy = note->illum >= 2 || (note->illum < 0 && says && note->exponent > 0);
	bool fit = true;
	if (note->illum >= 4) {
		char text[24];
		snprintf(text, sizeof text, "illum %d", note->illum);
		import_ignore(im, text);
	}
	if (!glossy)
		return true;
	m->roughness = mtl_roughness(note->exponent);
	for (int c = 0; c < 3; c++) {
		fit &= import_fit(&m->specular[c], ks[c], 1.0);
		m->specular_weight = fmaxf(m->specular_weight, m->specular[c]);
	}
	return fit;
}

bool mtl_is_normal_map(const uint32_t *texels, uint32_t width, uint32_t height)
{
	const size_t count = (size_t)width * height;
	uint64_t sum[3] = {0, 0, 0};
	for (size_t i = 0; i < count; i++)
		for (int c = 0; c < 3; c++)
			sum[c] += texels[i] >> (8 * c) & 255u;
	double mean[3];
	for (int c = 0; c < 3; c++)
		mean[c] = (double)sum[c] / (255.0 * (double)count);
	return fabs(mean[0] - 0.5) < 0.1 && fabs(mean[1] - 0.5) < 0.1 && mean[2] > 0.75;
}

static double height_at(const uint32_t *texels, uint32_t width, uint32_t x, uint32_t y)
{
	const uint32_t texel = texels[(size_t)y * width + x];
	return ((texel & 255u) + (texel >> 8 & 255u) + (texel >> 16 & 255u)) / 765.0;
}

static uint32_t encoded(double component)
{
	return (uint32_t)lround((component * 0.5 + 0.5) * 255.0);
}

enum status mtl_normals_of_heights(const uint32_t *texels, uint32_t width, uint32_t height, uint32_t **out,
				   struct error *err)
{
	*out = malloc((size_t)width * height * sizeof **out); // both ≤ LIMIT_TEXTURE_SIDE
	if (!*out)
		return error_set(err, STATUS_MEMORY, "no memory for a normal map of %u x %u", width, height);
	for (uint32_t y = 0; y < height; y++)
		for (uint32_t x = 0; x < width; x++) {
			const uint32_t left = (x + width - 1) % width, right = (x + 1) % width;
			const uint32_t above = (y + height - 1) % height, below = (y + 1) % height;
			const double dx = 0.5 * (height_at(texels, width, right, y) - height_at(texels, width, left, y));
			const double dy = 0.5 * (height_at(texels, width, x, above) - height_at(texels, width, x, below));
			const double scale = 1 / sqrt(dx * dx + dy * dy + 1);
			(*out)[(size_t)y * width + x] =
			    encoded(-dx * scale) | encoded(-dy * scale) << 8 | encoded(scale) << 16 | 255u << 24;
		}
	return STATUS_OK;
}
