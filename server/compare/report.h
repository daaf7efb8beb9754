// What candil-compare says and draws.
#ifndef CANDIL_COMPARE_REPORT_H
#define CANDIL_COMPARE_REPORT_H

#include "server/compare/metrics.h"

struct report {
	struct metrics metrics;
	uint64_t perceptual_failures; // pixels
	const char *name_a, *name_b;
	double mask_above; // +infinity: no mask
};

// To standard output: a table for people, or one JSON object.
void report_print(const struct report *report);
enum status report_print_json(const struct report *report, struct error *err);

// In place of report_print_json, the failure as the other commands of candil print theirs.
void report_print_failure(const struct error *failure, int exit_code);

// The scale of the error image, in words.
void report_print_scale(void);

// The false-colour image of `error` (as metrics_compare fills it): masked pixels mid-grey, non-finite ones green.
enum status report_draw_error(const char *path, uint32_t width, uint32_t height, const float *error, struct error *err);

// A, B (clipped at 1, sRGB) and the error image beside one another.
enum status report_draw_side_by_side(const char *path, const struct picture *a, const struct picture *b, const float *error,
				     struct error *err);

#endif
