#include "server/compare/report.h"

#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/status.h"
#include "server/base/replace.h"
#include "server/compare/heat.h"
#include "server/worker/image/view.h"

static void print_mean(const char *label, double mean, const double rgb[3])
{
	printf("%-22s %.6g  (R %.6g, G %.6g, B %.6g)\n", label, mean, rgb[0], rgb[1], rgb[2]);
}

void report_print(const struct report *report)
{
	const struct metrics *m = &report->comparison.metrics;
	printf("%s against %s, %u x %u, %" PRIu64 " pixels\n", report->name_a, report->name_b, m->width, m->height,
	       m->pixels);
	printf("%-22s %.6g\n", "RMSE", m->rmse);
	printf("%-22s %.6g\n", "relMSE", m->relmse);
	printf("%-22s %+.6g", "mean difference", m->mean_difference);
	if (m->mean_b != 0)
		printf("  (%+.4f %%)", 100 * m->mean_difference / m->mean_b);
	printf("\n%-22s %.6g\n", "largest difference", m->max_abs);
	print_mean("mean", m->mean_a, m->mean_a_rgb);
	print_mean("mean of reference", m->mean_b, m->mean_b_rgb);
	printf("%-22s %" PRIu64 " pixels, %" PRIu64 " in the reference\n", "not finite", m->non_finite_a, m->non_finite_b);
	printf("%-22s %.6g, at most %.6g", "FLIP", report->comparison.flip.mean, report->comparison.flip.max);
	if (report->comparison.high_range)
		printf("  (the largest of %u exposures, %+.2f to %+.2f stops)", report->comparison.flip.exposures,
		       report->comparison.flip.exposure_low, report->comparison.flip.exposure_high);
	putchar('\n');
	for (unsigned i = 0; i < report->warning_count; i++)
		fprintf(stderr, "warning    %s\n", report->warnings[i]);
	if (isfinite(report->mask_above))
		printf("%-22s %" PRIu64 " pixels (reference above %g)\n", "masked", m->masked, report->mask_above);
}

// JSON has no representation of numbers that are not finite.
static json_t *number(double value)
{
	return isfinite(value) ? json_real(value) : json_null();
}

enum status report_print_json(const struct report *report, struct error *err)
{
	const struct metrics *m = &report->comparison.metrics;
	json_t *root = json_pack("{s:s, s:s, s:i, s:i, s:I, s:I, s:I, s:I}", "a", report->name_a, "b", report->name_b,
				 "width", (int)m->width, "height", (int)m->height, "pixels", (json_int_t)m->pixels, "masked",
				 (json_int_t)m->masked, "non_finite_a", (json_int_t)m->non_finite_a, "non_finite_b",
				 (json_int_t)m->non_finite_b);
	if (!root)
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "the file names are no UTF-8, which JSON needs; leave out --json");
	double relative = m->mean_b != 0 ? m->mean_difference / m->mean_b : (double)NAN;
	json_object_set_new(root, "rmse", number(m->rmse));
	json_object_set_new(root, "relmse", number(m->relmse));
	json_object_set_new(root, "mean_difference", number(m->mean_difference));
	json_object_set_new(root, "mean_difference_relative", number(relative));
	json_object_set_new(root, "max_abs", number(m->max_abs));
	json_object_set_new(root, "flip", number(report->comparison.flip.mean));
	json_object_set_new(root, "flip_max", number(report->comparison.flip.max));
	json_object_set_new(root, "flip_exposures",
			    report->comparison.high_range
				? json_pack("{s:f, s:f, s:i}", "low", report->comparison.flip.exposure_low, "high",
					    report->comparison.flip.exposure_high, "count",
					    (int)report->comparison.flip.exposures)
				: json_null());
	json_object_set_new(root, "mean_a", number(m->mean_a));
	json_object_set_new(root, "mean_b", number(m->mean_b));
	json_t *rgb_a = json_array(), *rgb_b = json_array();
	for (int c = 0; c < 3; c++) {
		json_array_append_new(rgb_a, number(m->mean_a_rgb[c]));
		json_array_append_new(rgb_b, number(m->mean_b_rgb[c]));
	}
	json_object_set_new(root, "mean_a_rgb", rgb_a);
	json_object_set_new(root, "mean_b_rgb", rgb_b);
	json_object_set_new(root, "mask_above", number(report->mask_above));
	json_t *warnings = json_array();
	for (unsigned i = 0; i < report->warning_count; i++)
		json_array_append_new(warnings, json_string(report->warnings[i]));
	json_object_set_new(root, "warnings", warnings);
	int failed = json_dumpf(root, stdout, JSON_INDENT(2));
	putchar('\n');
	json_decref(root);
	return failed ? error_set(err, STATUS_IO, "cannot write the JSON") : STATUS_OK;
}

void report_print_failure(const struct error *failure, int exit_code)
{
	json_t *message = json_string(failure->text);
	if (!message)
		message = json_string("a file whose name is no UTF-8 cannot be compared: standard error says why");
	json_t *root = json_pack("{s:{s:i, s:s, s:o}, s:i}", "error", "code", (int)failure->code, "name",
				 status_name(failure->code), "message", message, "exit", exit_code);
	json_dumpf(root, stdout, JSON_INDENT(2));
	putchar('\n');
	json_decref(root);
}

void report_print_scale(void)
{
	printf("error image: relative error of a pixel (the root of its relMSE), logarithmic\n");
	for (int i = 0; i <= 6; i++) {
		double error = HEAT_LOW * pow(HEAT_HIGH / HEAT_LOW, i / 6.0);
		uint8_t c[3];
		heat_colour(heat_position(error), c);
		printf("  %-8.3g #%02x%02x%02x%s\n", error, c[0], c[1], c[2],
		       i == 0   ? " and below"
		       : i == 6 ? " and above"
				: "");
	}
	printf("  masked   #777777\n  not finite #00ff00\n");
}

static void error_codes(float error, uint8_t codes[3])
{
	static const uint8_t masked[3] = {0x77, 0x77, 0x77}, broken[3] = {0, 0xff, 0};
	if (error >= 0)
		heat_colour(heat_position((double)error), codes);
	else
		memcpy(codes, error == -1.0f ? masked : broken, 3);
}

// An image library's own writing to a file does not tell of a full disk.
static enum status write_png(const char *path, uint32_t width, uint32_t height, const uint8_t *codes, struct error *err)
{
	uint8_t *bytes = NULL;
	size_t size = 0;
	enum status s = picture_encode("png", width, height, codes, &bytes, &size, err);
	if (s == STATUS_OK)
		s = replace_asked(path, bytes, size, err);
	free(bytes);
	return s;
}

enum status report_draw_error(const char *path, uint32_t width, uint32_t height, const float *error, struct error *err)
{
	size_t count = (size_t)width * height;
	uint8_t *codes = malloc(3 * count);
	if (!codes)
		return error_set(err, STATUS_MEMORY, "no memory for the error image");
	for (size_t i = 0; i < count; i++)
		error_codes(error[i], codes + 3 * i);
	enum status s = write_png(path, width, height, codes, err);
	free(codes);
	return s;
}

enum status report_draw_side_by_side(const char *path, const struct picture *a, const struct picture *b, const float *error,
				     struct error *err)
{
	size_t width = a->width;
	uint8_t *codes = malloc(9 * width * a->height);
	if (!codes)
		return error_set(err, STATUS_MEMORY, "no memory for the side-by-side image");
	for (size_t y = 0; y < a->height; y++)
		for (size_t x = 0; x < width; x++) {
			size_t pixel = y * width + x;
			uint8_t *row = codes + 9 * y * width;
			view_srgb8(CODEC_VIEW_NONE, 0, a->rgb + 3 * pixel, row + 3 * x);
			view_srgb8(CODEC_VIEW_NONE, 0, b->rgb + 3 * pixel, row + 3 * (width + x));
			error_codes(error[pixel], row + 3 * (2 * width + x));
		}
	enum status s = write_png(path, 3 * a->width, a->height, codes, err);
	free(codes);
	return s;
}
