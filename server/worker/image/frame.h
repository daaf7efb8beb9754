// A picture in host memory. The device's thread fills it and hands it to the encoder's thread, which owns it from then on.
// One thread at a time.
#ifndef CANDIL_WORKER_FRAME_H
#define CANDIL_WORKER_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/asked.h"
#include "protocol/limits.h"
#include "server/base/error.h"
#include "server/base/estimate.h"
#include "server/base/work.h"

#define FRAME_METADATA_MAX 80u // entries of each list at most
#define FRAME_STAGES_MAX (LIMIT_STAGES - 4u) // the front adds what it knows
#define FRAME_FIGURES_MAX LIMIT_FIGURES // one more is told in the log, and left out
#define FRAME_NOTES_MAX 4u

// The stages that a device spends once, of every technique: opening it, and compiling programs that it does not have yet.
#define FRAME_STAGE_OPEN "open"
#define FRAME_STAGE_COMPILE "compile"

// The time that a stage of the job took, for the reply's account.
struct frame_stage {
	char name[24];
	uint64_t us;
};

// Something measured or counted: name "entries", value 1234, unit "".
struct frame_figure {
	char name[24];
	double value; // finite
	char unit[16];
};

// A picture, its AOVs, and what the reply and the file tell of it.
struct frame {
	uint32_t width, height; // pixels
	uint32_t made_width, made_height; // pixels that were rendered: the same, unless they were scaled (scale.h)
	// Row by row from the top. AOVs that are not asked for are NULL.
	float *radiance; // 3 floats a pixel: R G B, W/(m² sr), linear Rec.709
	float *depth; // 1: metres along the view axis; +inf: nothing hit
	float *normal; // 3: world space, unit; 0: nothing hit
	float *albedo; // 3: linear Rec.709
	uint32_t *id; // 1: material index + 1; 0: nothing hit

	// A file that is no picture: it is there in place of pixels. A sealed memfd, closed with the frame; -1: it is one.
	int file;
	uint64_t file_bytes;

	uint32_t samples; // of a pixel, in this picture
	uint32_t ahead; // if samples is 0: tiles of the picture, from its first on, that have one all the same
	struct estimate estimate; // of its error
	bool diagram; // it shows something else than light: what is missed or dark in it is no mistake
	bool *met; // 1 a pixel, as radiance: a sample met a surface
	uint64_t non_finite_samples; // samples that were infinite or NaN and count as black
	uint64_t rays; // traced
	struct frame_stage stages[FRAME_STAGES_MAX];
	uint32_t stage_count;
	uint64_t cold_us; // of the stages: what a device spends once
	struct work work; // of the stages: what was made once for the scene
	struct frame_figure figures[FRAME_FIGURES_MAX];
	uint32_t figure_count;
	char notes[FRAME_NOTES_MAX][192]; // sentences on what may surprise
	uint32_t note_count;

	// Each entry goes into the file as candil/KEY = VALUE.
	struct {
		char key[32];
		char value[ASKED_TEXT_BYTES];
	} metadata[FRAME_METADATA_MAX];
	uint32_t metadata_count;
};

// Make a zeroed frame with radiance and the AOVs of `aovs` (AOV_* bits of protocol/header.h). Its size must have passed the
// request's limits. *frame is the caller's. STATUS_MEMORY.
enum status frame_create(uint32_t width, uint32_t height, uint32_t aovs, struct frame **frame, struct error *err);

// Make a frame without pixels of a file, which it owns. STATUS_MEMORY: it stays the caller's.
enum status frame_create_file(uint32_t width, uint32_t height, int file, uint64_t bytes, struct frame **frame,
			      struct error *err);

// Free a frame. NULL is allowed.
void frame_destroy(struct frame *frame);

// Was it made of other pixels than it has?
static inline bool frame_is_scaled(const struct frame *frame)
{
	return frame->made_width != frame->width || frame->made_height != frame->height;
}

// Give `frame` the pixels of `from`, with its width and height, in the place of its own, and free `from`.
void frame_take_pixels(struct frame *frame, struct frame *from);

// Append to the lists. What is beyond a list's maximum is dropped. Text is printf-formatted and cut to fit.
void frame_add_metadata(struct frame *frame, const char *key, const char *format, ...) __attribute__((format(printf, 3, 4)));
// A stage that is there already grows. One that a device spends once counts as cold, too.
void frame_add_stage(struct frame *frame, const char *name, uint64_t us);
// The same for a list of stages alone.
void frame_stages_add(struct frame_stage stages[FRAME_STAGES_MAX], uint32_t *count, const char *name, uint64_t us);
void frame_add_figure(struct frame *frame, const char *name, double value, const char *unit);
void frame_add_note(struct frame *frame, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
