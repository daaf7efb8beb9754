// The output of candil-compare: text, JSON and pictures. One thread.
#ifndef CANDIL_COMPARE_REPORT_H
#define CANDIL_COMPARE_REPORT_H

#include "server/compare/comparison.h"

struct report {
	struct comparison comparison;
	const char *name_a, *name_b;
	double mask_above; // radiance; +infinity: no mask
	char warnings[ORIGIN_WARNINGS_MAX][ORIGIN_WARNING_BYTES]; // `warning_count` of them
	unsigned warning_count;
};

// Print to standard output: a table for people, with warnings on standard error, or one JSON object. STATUS_BAD_ARGUMENT if
// a file name is not UTF-8, STATUS_IO.
void report_print(const struct report *report);
enum status report_print_json(const struct report *report, struct error *err);

// In place of report_print_json: print a failure in the format of candil's other commands.
void report_print_failure(const struct error *failure, int exit_code);

// Print the scale of the error image.
void report_print_scale(void);

// Write the false-colour image of `error` (as metrics_compare fills it) as a PNG: masked pixels are mid-grey, non-finite
// ones green. STATUS_MEMORY, STATUS_IO, STATUS_ENCODE.
enum status report_draw_error(const char *path, uint32_t width, uint32_t height, const float *error, struct error *err);

// Write A, B (clipped at 1, sRGB) and the error image side by side as a PNG. Failures as report_draw_error.
enum status report_draw_side_by_side(const char *path, const struct picture *a, const struct picture *b, const float *error,
				     struct error *err);

#endif
