// Design note. Attempts that were given up cost about as much as the last of them is worth: each is begun only if it has
// GROWTH_LEAST times the pixels of the one before it. One that has few pixels overestimates what a pixel takes, because
// sending work to a device takes time, too; so what was measured in less than TRUSTED_US is used to come by another
// measurement, with a small part of the time that is left.
#include "server/worker/attempts.h"

#include <math.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/base/side.h"
#include "server/base/stage.h"
#include "server/worker/devices.h"
#include "server/worker/image/scale.h"
#include "server/worker/plan/plan.h"
#include "server/worker/vk/device.h"
#include "shaders/shared/bindings.h"

#define GROWTH_LEAST 2.0 // in pixels, from one attempt to the next
#define GROWTH_MOST 64.0 // if the next attempt is late for its first sample, the one before it is shown
#define TRUSTED_US 5000.0 // of a sample of every pixel, from which on it tells what more pixels take
#define PART 0.5 // of the time that is left, for the first sample of every pixel
#define PART_UNSURE 0.1 // the same, by a measurement that is not trusted

static double pixels_of(struct size size)
{
	return (double)size.width * size.height;
}

static struct size asked(const struct attempts *a)
{
	return (struct size){a->plan->width, a->plan->height};
}

static bool is_timed(const struct attempts *a)
{
	return a->plan->end_us > 0;
}

static bool is_whole(const struct attempts *a)
{
	return a->size.width == a->plan->width && a->size.height == a->plan->height;
}

// Is it the one that is made whatever the deadline is?
static bool is_first(const struct attempts *a)
{
	return !a->sure && !a->plan->whole;
}

// A number of pixels near `wanted` along an axis of `side`, so that no code is compiled for it alone.
static uint32_t near(const struct attempts *a, double wanted, uint32_t side)
{
	const uint32_t n = (uint32_t)fmin(fmax(round(wanted), 1), side);
	return a->devices->vk->info.software ? side_near(n, side) : n;
}

// The size of a picture with about so many pixels, in the shape of the one that was asked for as far as can be.
static struct size size_with(const struct attempts *a, double pixels)
{
	const double scale = sqrt(fmin(pixels / pixels_of(asked(a)), 1));
	struct size size = {near(a, a->plan->width * scale, a->plan->width),
			    near(a, a->plan->height * scale, a->plan->height)};
	// The shorter axis may have got more than its share, and the longer one then gets less.
	if (size.width < size.height)
		size.height = near(a, fmin(a->plan->height * scale, pixels / size.width), a->plan->height);
	else
		size.width = near(a, fmin(a->plan->width * scale, pixels / size.height), a->plan->width);
	return size;
}

void attempts_init(struct attempts *a, const struct technique *technique, struct devices *devices,
		   struct resident_scene *scene, const struct plan *plan)
{
	*a = (struct attempts){.technique = technique, .devices = devices, .scene = scene, .plan = plan};
	a->size = is_timed(a) && !plan->whole ? size_with(a, TILE_PIXELS) : asked(a);
	a->is_last = is_whole(a);
}

enum status attempts_begin(struct attempts *a, struct error *err)
{
	struct plan plan = *a->plan;
	plan.width = a->size.width;
	plan.height = a->size.height;
	if (is_timed(a) && is_first(a))
		plan.end_us = 0;
	// Its error would be that of another picture.
	if (!is_whole(a))
		plan.target_error = 0;
	return a->technique->begin(a->devices, a->scene, &plan, &a->work, err);
}

enum status attempts_time_effects(struct attempts *a, candil_EffectReport *reports, uint32_t count, struct error *err)
{
	if (!a->technique->time_effects)
		return STATUS_OK;
	const enum status s = a->technique->time_effects(a->work, reports, count, err);
	const double more = pixels_of(asked(a)) / pixels_of(a->size);
	for (uint32_t i = 0; i < count && !is_whole(a); i++)
		reports[i].cost_us = (int64_t)((double)reports[i].cost_us * more);
	return s;
}

// Keep what a frame's stages took under the same names, but for the samples: they are not in the picture.
static void keep_stages(struct attempts *a, const struct frame *f)
{
	for (uint32_t i = 0; i < f->stage_count; i++) {
		const enum stage_kind kind = stage_kind(f->stages[i].name);
		const char *name = kind == STAGE_COLD || kind == STAGE_SETUP ? f->stages[i].name : "size";
		uint32_t at = 0;
		while (at < a->stage_count && strcmp(a->stages[at].name, name) != 0)
			at++;
		if (at == FRAME_STAGES_MAX)
			continue;
		if (at == a->stage_count)
			memcpy(a->stages[a->stage_count++].name, name, strlen(name) + 1);
		a->stages[at].us += f->stages[i].us;
	}
}

// About how many pixels the next attempt is to have, as the one under way takes sample_us for a sample of all of its own.
static double next_pixels(const struct attempts *a, double sample_us)
{
	const uint64_t now = clock_us();
	const double left_us = a->plan->end_us > now ? (double)(a->plan->end_us - now) : 0;
	const double has = pixels_of(a->size), us = fmax(sample_us, 1);
	const double part = us >= TRUSTED_US || us * pixels_of(asked(a)) / has <= PART * left_us ? PART : PART_UNSURE;
	return has * fmin(part * left_us / us, GROWTH_MOST);
}

// The attempt has a sample of every pixel. Is another worth while? Then what this one came to is kept, and the next is to be
// begun.
static enum status go_on(struct attempts *a, const struct step_result *result, struct error *err)
{
	const struct size next = size_with(a, next_pixels(a, result->sample_us));
	struct frame *f;
	a->has_sample = true;
	frame_destroy(a->sure);
	a->sure = NULL;
	a->is_last = a->is_last || pixels_of(next) < GROWTH_LEAST * pixels_of(a->size);
	if (a->is_last)
		return STATUS_OK;
	const enum status s = a->technique->read(a->work, &f, err);
	if (s != STATUS_OK)
		return s;
	keep_stages(a, f);
	a->sure = f;
	a->technique->end(a->work);
	a->work = NULL;
	a->size = next;
	a->is_last = is_whole(a);
	a->has_sample = false;
	return STATUS_OK;
}

// What a step of a job with a deadline means for the picture that was asked for.
static void judge(const struct attempts *a, struct step_result *result)
{
	const uint64_t now = clock_us();
	const bool over = now >= a->plan->end_us;
	if (!a->has_sample) {
		result->samples_done = 0;
		result->finished = result->reached = false;
		// The first one goes on without an end: what is left of it is less than a tile of the picture takes.
		result->late = (result->late || over) && (!is_first(a) || !result->drawing);
	} else if (!is_whole(a)) {
		result->late = result->late || result->finished || over;
		result->finished = result->reached = false;
	} else if (!result->finished) {
		result->late = result->late || over;
	}
	if (result->late)
		log_line(LOG_DEBUG, "%u x %u pixels: %lld us past the end", a->size.width, a->size.height,
			 (long long)(now - a->plan->end_us));
	if (!is_whole(a) || !a->has_sample)
		result->estimate = ESTIMATE_UNKNOWN;
	if (!a->is_last)
		result->fraction = 0;
}

// What is left of a slice until the end. The first attempt has no end of its own.
static uint32_t within(const struct attempts *a, uint32_t budget_us)
{
	const uint64_t now = clock_us();
	if (!is_timed(a) || now + budget_us <= a->plan->end_us)
		return budget_us;
	return a->plan->end_us > now ? (uint32_t)(a->plan->end_us - now) : 1;
}

enum status attempts_step(struct attempts *a, uint32_t budget_us, struct step_result *result, struct error *err)
{
	enum status s = a->work ? STATUS_OK : attempts_begin(a, err);
	if (s == STATUS_OK)
		s = a->technique->step(a->work, within(a, budget_us), result, err);
	if (s != STATUS_OK)
		return s;
	if (!is_timed(a)) {
		a->has_sample = result->samples_done > 0;
		return STATUS_OK;
	}
	if (!a->has_sample && result->samples_done > 0)
		s = go_on(a, result, err);
	judge(a, result);
	return s;
}

bool attempts_ready(const struct attempts *a)
{
	return a->has_sample || a->sure;
}

enum status attempts_read(struct attempts *a, struct frame **frame, struct error *err)
{
	struct frame *f = a->sure;
	if (a->has_sample) {
		const enum status s = a->technique->read(a->work, &f, err);
		if (s != STATUS_OK)
			return s;
	} else if (!f) {
		return error_set(err, STATUS_INTERNAL, "there is no picture to read");
	} else {
		a->sure = NULL;
		f->stage_count = 0;
		f->cold_us = 0;
	}
	for (uint32_t i = 0; i < a->stage_count; i++)
		frame_add_stage(f, a->stages[i].name, a->stages[i].us);
	if (f->width != a->plan->width || f->height != a->plan->height) {
		f->estimate = ESTIMATE_UNKNOWN;
		frame_add_note(f, "there was time for %u x %u pixels alone: they are scaled, and their error is not known",
			       f->width, f->height);
		const enum status s = frame_scale(f, a->plan->width, a->plan->height, err);
		if (s != STATUS_OK) {
			frame_destroy(f);
			return s;
		}
	}
	*frame = f;
	return STATUS_OK;
}

void attempts_end(struct attempts *a)
{
	if (a->work)
		a->technique->end(a->work);
	frame_destroy(a->sure);
	*a = (struct attempts){0};
}
