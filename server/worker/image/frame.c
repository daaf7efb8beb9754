#include "server/worker/image/frame.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "protocol/header.h"
#include "server/base/checked.h"
#include "server/base/log.h"

// Make a zeroed plane of `components` 4-byte values a pixel. NULL: out of memory.
static void *plane(size_t pixels, size_t components)
{
	size_t values;
	if (!checked_mul(pixels, components, &values))
		return NULL;
	return calloc(values, sizeof(float));
}

enum status frame_create(uint32_t width, uint32_t height, uint32_t aovs, struct frame **frame, struct error *err)
{
	size_t pixels;
	if (width == 0 || height == 0 || !checked_mul(width, height, &pixels) || pixels > LIMIT_PIXELS)
		return error_set(err, STATUS_LIMIT,
				 "a frame of %u x %u pixels is not within 1 and %u pixels; ask for a smaller one", width,
				 height, LIMIT_PIXELS);
	struct frame *f = calloc(1, sizeof *f);
	if (!f)
		goto out_of_memory;
	f->width = f->made_width = width;
	f->height = f->made_height = height;
	f->estimate = ESTIMATE_UNKNOWN;
	f->file = -1;
	f->radiance = plane(pixels, 3);
	f->met = calloc(pixels, sizeof *f->met);
	if (aovs & AOV_DEPTH)
		f->depth = plane(pixels, 1);
	if (aovs & AOV_NORMAL)
		f->normal = plane(pixels, 3);
	if (aovs & AOV_ALBEDO)
		f->albedo = plane(pixels, 3);
	if (aovs & AOV_ID)
		f->id = plane(pixels, 1);
	if (!f->radiance || !f->met || ((aovs & AOV_DEPTH) && !f->depth) || ((aovs & AOV_NORMAL) && !f->normal) ||
	    ((aovs & AOV_ALBEDO) && !f->albedo) || ((aovs & AOV_ID) && !f->id))
		goto out_of_memory;
	*frame = f;
	return STATUS_OK;

out_of_memory:
	frame_destroy(f);
	return error_set(err, STATUS_MEMORY, "no memory for a frame of %u x %u pixels; ask for a smaller one or fewer AOVs",
			 width, height);
}

enum status frame_create_file(uint32_t width, uint32_t height, int file, uint64_t bytes, struct frame **frame,
			      struct error *err)
{
	struct frame *f = calloc(1, sizeof *f);
	if (!f)
		return error_set(err, STATUS_MEMORY, "out of memory");
	f->width = f->made_width = width;
	f->height = f->made_height = height;
	f->estimate = ESTIMATE_UNKNOWN;
	f->file = file;
	f->file_bytes = bytes;
	*frame = f;
	return STATUS_OK;
}

static void free_pixels(struct frame *f)
{
	free(f->radiance);
	free(f->met);
	free(f->depth);
	free(f->normal);
	free(f->albedo);
	free(f->id);
}

void frame_destroy(struct frame *frame)
{
	if (!frame)
		return;
	free_pixels(frame);
	if (frame->file >= 0)
		close(frame->file);
	free(frame);
}

void frame_take_pixels(struct frame *frame, struct frame *from)
{
	free_pixels(frame);
	frame->width = from->width;
	frame->height = from->height;
	frame->radiance = from->radiance;
	frame->met = from->met;
	frame->depth = from->depth;
	frame->normal = from->normal;
	frame->albedo = from->albedo;
	frame->id = from->id;
	free(from);
}

void frame_add_metadata(struct frame *frame, const char *key, const char *format, ...)
{
	if (frame->metadata_count >= FRAME_METADATA_MAX)
		return;
	uint32_t i = frame->metadata_count++;
	snprintf(frame->metadata[i].key, sizeof frame->metadata[i].key, "%s", key);
	va_list args;
	va_start(args, format);
	vsnprintf(frame->metadata[i].value, sizeof frame->metadata[i].value, format, args);
	va_end(args);
}

void frame_stages_add(struct frame_stage stages[FRAME_STAGES_MAX], uint32_t *count, const char *name, uint64_t us)
{
	uint32_t at = 0;
	while (at < *count && strcmp(stages[at].name, name) != 0)
		at++;
	if (at == FRAME_STAGES_MAX)
		return;
	if (at == *count) {
		snprintf(stages[at].name, sizeof stages[at].name, "%s", name);
		stages[at].us = 0;
		++*count;
	}
	stages[at].us += us;
}

void frame_add_stage(struct frame *frame, const char *name, uint64_t us)
{
	frame_stages_add(frame->stages, &frame->stage_count, name, us);
	if (!strcmp(name, FRAME_STAGE_OPEN) || !strcmp(name, FRAME_STAGE_COMPILE))
		frame->cold_us += us;
}

void frame_add_figure(struct frame *frame, const char *name, double value, const char *unit)
{
	if (frame->figure_count >= FRAME_FIGURES_MAX) {
		log_line(LOG_WARNING, "the figure %s is not told: there is room for %u (LIMIT_FIGURES)", name,
			 FRAME_FIGURES_MAX);
		return;
	}
	struct frame_figure *f = &frame->figures[frame->figure_count++];
	snprintf(f->name, sizeof f->name, "%s", name);
	snprintf(f->unit, sizeof f->unit, "%s", unit);
	f->value = value;
}

void frame_add_note(struct frame *frame, const char *format, ...)
{
	if (frame->note_count >= FRAME_NOTES_MAX)
		return;
	va_list args;
	va_start(args, format);
	vsnprintf(frame->notes[frame->note_count++], sizeof frame->notes[0], format, args);
	va_end(args);
}
