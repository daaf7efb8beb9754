#include "server/loader/environment.h"

#include <math.h>
#include <stdlib.h>

#include "protocol/limits.h"
#include "server/base/angle.h"
#include "server/base/luminance.h"
#include "server/scene/alias.h"

// ---- mending ----------------------------------------------------------------------------------------------------------

struct mended {
	size_t no_number, negative, infinite, bright;
};

// The largest finite value stands in for infinities. A half float turns a sun that is too bright into an infinity, and this
// value is nearest to it.
static float brightest(const float *values, size_t count)
{
	float most = 0;
	for (size_t i = 0; i < count; i++)
		if (isfinite(values[i]) && values[i] > most)
			most = values[i];
	return most;
}

static float mend(float value, float most, struct mended *mended)
{
	if (isnan(value)) {
		mended->no_number++;
		return 0;
	}
	if (value < 0) {
		mended->negative++;
		return 0;
	}
	if (isinf(value)) {
		mended->infinite++;
		value = most;
	}
	mended->bright += (double)value > LIMIT_RADIANCE;
	return (double)value > LIMIT_RADIANCE ? (float)LIMIT_RADIANCE : value + 0.0f; // adding zero avoids a negative zero
}

static void mend_all(struct import *im, float *values, size_t count)
{
	struct mended mended = {0};
	const float most = brightest(values, count);
	for (size_t i = 0; i < count; i++)
		values[i] = mend(values[i], most, &mended);
	if (mended.no_number)
		import_warn(im, "values of the picture taken as 0 because they are no numbers: %zu", mended.no_number);
	if (mended.negative)
		import_warn(im, "values of the picture taken as 0 because they are below it: %zu", mended.negative);
	if (mended.infinite)
		import_warn(im, "infinite values of the picture taken as its largest finite one, %g: %zu", (double)most,
			    mended.infinite);
	if (mended.bright)
		import_warn(im, "values of the picture cut to %g: %zu", LIMIT_RADIANCE, mended.bright);
}

// ---- the table --------------------------------------------------------------------------------------------------------

// Solid angle of a texel in that row, sr: its width in longitude times the difference in height of its edges on the unit
// sphere.
static double solid_angle(const struct import *im, uint32_t row)
{
	const double step = PI / im->environment_height;
	return 2 * PI / im->environment_width * 2 * sin((row + 0.5) * step) * sin(0.5 * step);
}

// Mean over a texel of the bilinear interpolation. Along each axis, its own value has weight 6/8 and its two neighbours 1/8
// each.
static double mean_luminance(const struct import *im, const float *lum, uint32_t x, uint32_t y)
{
	const uint32_t w = im->environment_width, h = im->environment_height;
	const uint32_t columns[3] = {x > 0 ? x - 1 : w - 1, x, x + 1 < w ? x + 1 : 0};
	const uint32_t lines[3] = {y > 0 ? y - 1 : 0, y, y + 1 < h ? y + 1 : h - 1};
	static const double share[3] = {0.125, 0.75, 0.125};
	double sum = 0;
	for (int j = 0; j < 3; j++)
		for (int i = 0; i < 3; i++)
			sum += share[i] * share[j] * (double)lum[(size_t)lines[j] * w + columns[i]];
	return sum;
}

// Fill in the weights. Returns whether there is any light.
static bool weigh(const struct import *im, const float *lum, double *weights)
{
	bool light = false;
	for (uint32_t y = 0; y < im->environment_height; y++) {
		const double solid = solid_angle(im, y);
		for (uint32_t x = 0; x < im->environment_width; x++) {
			double *weight = &weights[(size_t)y * im->environment_width + x];
			*weight = mean_luminance(im, lum, x, y) * solid;
			light |= *weight > 0;
		}
	}
	// A black map is sampled uniformly, if at all: the table must be valid.
	for (uint32_t y = 0; y < im->environment_height && !light; y++)
		for (uint32_t x = 0; x < im->environment_width; x++)
			weights[(size_t)y * im->environment_width + x] = solid_angle(im, y);
	return light;
}

static void fill(struct import *im, const float *rgb, const struct alias_row *rows)
{
	for (uint32_t y = 0; y < im->environment_height; y++) {
		const double solid = solid_angle(im, y);
		for (uint32_t x = 0; x < im->environment_width; x++) {
			const size_t i = (size_t)y * im->environment_width + x;
			struct environment_texel *t = &im->environment[i];
			for (int c = 0; c < 3; c++)
				t->radiance[c] = rgb[3 * i + (size_t)c];
			t->pdf = (float)((double)rows[i].pmf / solid);
			im->environment_rows[i] = (struct environment_row){rows[i].keep, rows[i].alias};
		}
	}
}

// `environment_contrast` of struct blob_header, for the table that `fill` has made.
static double contrast(const struct import *im)
{
	double sum = 0;
	for (uint32_t y = 0; y < im->environment_height; y++) {
		const double solid = solid_angle(im, y);
		for (uint32_t x = 0; x < im->environment_width; x++) {
			const double pdf = im->environment[(size_t)y * im->environment_width + x].pdf;
			sum += pdf * pdf * solid;
		}
	}
	return 4 * PI * sum;
}

enum status environment_build(struct import *im, const float *rgb, struct error *err)
{
	const size_t count = (size_t)im->environment_width * im->environment_height;
	float *lum = malloc(count * sizeof *lum);
	double *weights = calloc(count, sizeof *weights), sum;
	struct alias_row *rows = malloc(count * sizeof *rows);
	enum status status = STATUS_OK;

	im->environment = malloc(count * sizeof *im->environment);
	im->environment_rows = malloc(count * sizeof *im->environment_rows);
	if (!lum || !weights || !rows || !im->environment || !im->environment_rows) {
		status = error_set(err, STATUS_MEMORY, "no memory for a picture of %zu texels", count);
		goto out;
	}
	for (size_t i = 0; i < count; i++)
		lum[i] = (float)luminance(&rgb[3 * i]);
	const bool light = weigh(im, lum, weights);
	status = alias_build(weights, count, rows, &sum, err);
	if (status == STATUS_OK)
		fill(im, rgb, rows);
	im->environment_power = light ? (float)sum : 0;
	im->environment_contrast = status == STATUS_OK ? (float)contrast(im) : 0;
out:
	free(rows);
	free(weights);
	free(lum);
	return status;
}

// ---- the file ---------------------------------------------------------------------------------------------------------

static enum status read_picture(struct import *im, const char *file, struct image_reader *reader, struct error *err)
{
	const uint64_t count = (uint64_t)im->environment_width * im->environment_height;
	struct error why;
	if (count > LIMIT_ENVIRONMENT_TEXELS)
		return error_set(err, STATUS_SCENE_LIMIT,
				 "'%.100s' has %u x %u pixels, %u together are the most: scale it down", file,
				 im->environment_width, im->environment_height, LIMIT_ENVIRONMENT_TEXELS);
	float *rgb = malloc((size_t)count * 3 * sizeof *rgb);
	if (!rgb)
		return error_set(err, STATUS_MEMORY, "no memory for '%.100s'", file);
	enum status status = im->decoder->radiance(reader, rgb, &why);
	if (status == STATUS_OK) {
		mend_all(im, rgb, (size_t)count * 3);
		status = environment_build(im, rgb, err);
	} else {
		error_set(err, status, "'%.60s': %.150s", file, why.text);
	}
	free(rgb);
	return status;
}

enum status environment_import(struct import *im, const char *file, const struct file_bytes *bytes, struct error *err)
{
	struct image_reader *reader;
	struct error why;
	uint32_t width, height;
	if (import_expect_images(im, err) != STATUS_OK)
		return err->code;
	if (im->decoder->open_surroundings(bytes->data, bytes->size, &reader, &width, &height, &why) != STATUS_OK)
		return error_set(err, why.code, "'%.60s': %.150s", file, why.text);
	im->environment_width = width;
	im->environment_height = height;
	if (width != 2 * height)
		import_warn(
		    im, "the picture has %u x %u pixels: one of all directions is twice as wide as high, and so it is taken",
		    width, height);
	enum status status = read_picture(im, file, reader, err);
	if (status == STATUS_OK && im->environment_power == 0)
		import_warn(im, "the picture is black");
	im->decoder->close(reader);
	return status;
}
