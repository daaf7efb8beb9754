// A picture in host memory, between the device's thread (which fills it) and the encoder's (which owns it from then on).
#ifndef CANDIL_WORKER_FRAME_H
#define CANDIL_WORKER_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/limits.h"
#include "server/base/error.h"

#define FRAME_METADATA_MAX 32u
#define FRAME_STAGES_MAX (LIMIT_STAGES - 1u) // the front adds the wait
#define FRAME_FIGURES_MAX 32u
#define FRAME_NOTES_MAX 2u

struct frame_stage {
	char name[24];
	uint64_t us;
};

// Something measured or counted, by name: "entries" 1234 "".
struct frame_figure {
	char name[24];
	double value; // finite
	char unit[16];
};

struct frame {
	uint32_t width, height;
	// Row by row from the top, width × height pixels each. radiance: R G B, W/(m² sr), linear Rec.709. Others NULL if
	// not asked.
	float *radiance; // 3 floats a pixel
	float *depth; // 1: metres along the view axis, +inf: nothing hit
	float *normal; // 3: world space, unit; 0: nothing hit
	float *albedo; // 3
	uint32_t *id; // 1: material index + 1; 0: nothing hit

	uint32_t samples; // per pixel, in this picture
	double estimated_relmse; // negative: unknown
	uint64_t non_finite_samples;
	uint64_t rays;
	struct frame_stage stages[FRAME_STAGES_MAX];
	uint32_t stage_count;
	struct frame_figure figures[FRAME_FIGURES_MAX];
	uint32_t figure_count;
	char notes[FRAME_NOTES_MAX][192]; // sentences on what may surprise
	uint32_t note_count;

	// Goes into the file as candil/KEY = VALUE.
	struct {
		char key[32];
		char value[160];
	} metadata[FRAME_METADATA_MAX];
	uint32_t metadata_count;
};

// A frame with radiance and the AOVs of `aovs` (AOV_* bits), zeroed. Sizes must have passed the request's limits.
enum status frame_create(uint32_t width, uint32_t height, uint32_t aovs, struct frame **frame, struct error *err);
void frame_destroy(struct frame *frame);

// Append; silently full at the maximum. Values are printf-formatted and cut to fit.
void frame_add_metadata(struct frame *frame, const char *key, const char *format, ...) __attribute__((format(printf, 3, 4)));
void frame_add_stage(struct frame *frame, const char *name, uint64_t us);
void frame_add_figure(struct frame *frame, const char *name, double value, const char *unit);
void frame_add_note(struct frame *frame, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
