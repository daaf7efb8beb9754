// Design note. What a sample takes has a part that grows with the pixels and one that does not: triangles that are drawn,
// orders on their way to the device. The first attempt is too small to tell them apart, so what follows it is more of a
// guess than what follows two. A wrong guess costs little: what came before it is shown, and has nearly as few pixels.
#include "server/worker/attempts.h"

#include <math.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/base/side.h"
#include "server/base/stage.h"
#include "server/worker/devices.h"
#include "server/worker/image/scale.h"
#include "server/worker/plan/plan.h"
#include "server/worker/vk/device.h"
#include "shaders/shared/bindings.h"

#define GROWTH_LEAST 2.0 // in pixels, from one attempt to the next: else the next is not worth what it takes
#define GROWTH_GUESSED 8.0 // at least, by one measurement
#define GROWTH_MOST 16.0 // if the next attempt is late for its first sample, the one before it is shown
#define NEARLY_SAME 2.0 // times what a sample takes: a picture that takes no more than that is made at once
#define PART 0.75 // of the time that is left, for the first sample of every pixel
#define PART_GUESSED 0.5 // the same, by one measurement

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
	return a->devices->vk->info.software && a->technique->sides_are_code ? side_near(n, side) : n;
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
	plan.first_sure = is_timed(a) && is_first(a);
	plan.forecasts = is_timed(a) ? a->forecasts : NULL;
	// Its error would be that of another picture.
	if (!is_whole(a))
		plan.target_error = 0;
	const uint64_t start = clock_us();
	const enum status s = a->technique->begin(a->devices, a->scene, &plan, &a->work, err);
	a->spent_us += clock_us() - start;
	return s;
}

enum status attempts_time_effects(struct attempts *a, candil_EffectReport *reports, uint32_t count, struct error *err)
{
	if (!a->technique->time_effects)
		return STATUS_OK;
	const enum status s = a->technique->time_effects(a->work, reports, count, err);
	// A picture of a few tiles tells shares, but not what all tiles together take.
	for (uint32_t i = 0; i < count && !is_whole(a); i++)
		reports[i].has_cost_us = false;
	return s;
}

// Keep what a frame's stages took under the same names, but for the samples: they are not in the picture.
static void keep_stages(struct attempts *a, const struct frame *f)
{
	for (uint32_t i = 0; i < f->stage_count; i++) {
		const enum stage_kind kind = stage_kind(f->stages[i].name);
		const char *name = kind == STAGE_COLD || kind == STAGE_SETUP ? f->stages[i].name : "size";
		frame_stages_add(a->stages, &a->stage_count, name, f->stages[i].us);
	}
}

// Microseconds that a sample of each pixel more takes, as the attempt under way takes `us` for all of its own: by it and the
// one before it, or if there was none as if nothing were the same for all sizes.
static double each_us(const struct attempts *a, double us)
{
	const double all = us / pixels_of(a->size), more = pixels_of(a->size) - a->before.pixels;
	return a->before.pixels > 0 ? fmin(fmax((us - a->before.us) / more, 0), all) : all;
}

// The size of the next attempt, as the one under way takes `us`; no more than that has: there is no time for another.
static struct size next_size(const struct attempts *a, double us)
{
	const uint64_t now = clock_us();
	const double left_us = a->plan->end_us > now ? (double)(a->plan->end_us - now) : 0;
	const double has = pixels_of(a->size), each = each_us(a, us), all = pixels_of(asked(a));
	const bool guessed = !(a->before.pixels > 0);
	// Where nearly all is the same for all sizes, steps to get there would cost as much as the whole.
	const bool at_once = !guessed && us + each * (all - has) <= NEARLY_SAME * us;
	const double most = at_once ? all : fmin(GROWTH_MOST * has, all);
	if (us + each * (most - has) <= PART * left_us)
		return size_with(a, most);
	if (us >= PART * left_us)
		return a->size;
	// `each` is above 0, or all would fit.
	const double fit = has + ((guessed ? PART_GUESSED : PART) * left_us - us) / each;
	return size_with(a, fmin(guessed ? fmax(fit, GROWTH_GUESSED * has) : fit, most));
}

// What was sure before is so no more: there is something better.
static void replace_sure(struct attempts *a, struct frame *f)
{
	if (a->sure)
		keep_stages(a, a->sure);
	frame_destroy(a->sure);
	a->sure = f;
}

// The attempt has a sample of every pixel. Is another worth while? Then what this one came to is kept, and the next is to be
// begun.
static enum status go_on(struct attempts *a, const struct step_result *result, struct error *err)
{
	const double us = fmax(result->sample_us, 1), has = pixels_of(a->size);
	const struct size next = a->is_last ? a->size : next_size(a, us);
	const bool whole = next.width == a->plan->width && next.height == a->plan->height;
	struct frame *f;
	if (a->is_last || pixels_of(next) < (whole ? 1 : GROWTH_LEAST) * has) {
		replace_sure(a, NULL);
		a->has_sample = a->is_last = true;
		return STATUS_OK;
	}
	const enum status s = a->technique->read(a->work, &f, err);
	if (s != STATUS_OK)
		return s;
	replace_sure(a, f);
	a->technique->end(a->work);
	a->work = NULL;
	a->before.pixels = has;
	a->before.us = us;
	a->size = next;
	a->is_last = whole;
	a->spent_us = 0;
	return STATUS_OK;
}

// What a step of a job with a deadline means for the picture that was asked for.
static void judge(struct attempts *a, struct step_result *result)
{
	const uint64_t now = clock_us();
	const bool over = now >= a->plan->end_us;
	if (!a->has_sample) {
		result->samples_done = 0;
		result->finished = result->reached = false;
		// The first one goes on to its sample: what is left of it is about what a tile of the picture takes.
		result->late = result->late || (over && !(is_first(a) && result->drawing));
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
	// Making what is made of the scene is the first attempt's work; drawing is the last one's.
	if (a->is_last || !result->drawing)
		a->fraction = fmax(a->fraction, result->fraction);
	result->fraction = a->fraction;
}

enum status attempts_step(struct attempts *a, uint32_t budget_us, struct step_result *result, struct error *err)
{
	enum status s = a->work ? STATUS_OK : attempts_begin(a, err);
	const uint64_t start = clock_us();
	if (s == STATUS_OK)
		s = a->technique->step(a->work, budget_us, result, err);
	a->spent_us += clock_us() - start;
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

bool attempts_scaled(const struct attempts *a)
{
	return attempts_ready(a) && !(a->has_sample && is_whole(a));
}

// The attempt under way came to some of its tiles: the rest of its picture is that of the one before it. false: to none.
static bool patch(struct attempts *a, struct frame **frame)
{
	struct frame *f = NULL;
	struct error ignored;
	bool good = a->work && a->technique->read(a->work, &f, &ignored) == STATUS_OK && f->ahead > 0;
	if (good) {
		const uint32_t width = a->sure->width, height = a->sure->height;
		good = frame_scale(a->sure, f->width, f->height, &ignored) == STATUS_OK;
		f->made_width = width;
		f->made_height = height;
	}
	if (!good) {
		frame_destroy(f);
		return false;
	}
	const double tiles = (double)((f->width + TILE_SIDE - 1) / TILE_SIDE) * ((f->height + TILE_SIDE - 1) / TILE_SIDE);
	frame_add_note(f, "%.3g %% of the picture, from the top, are made of %u x %u pixels", 100 * f->ahead / tiles,
		       f->width, f->height);
	frame_fill(f, a->sure, TILE_SIDE);
	f->samples = a->sure->samples;
	replace_sure(a, NULL);
	*frame = f;
	return true;
}

// The frame as the attempts have it, and its account.
static enum status read_frame(struct attempts *a, struct frame **frame, struct error *err)
{
	enum status s = STATUS_OK;
	if (a->has_sample)
		s = a->technique->read(a->work, frame, err);
	else if (!a->sure)
		s = error_set(err, STATUS_INTERNAL, "there is no picture to read");
	if (s != STATUS_OK)
		return s;
	if (!a->has_sample && !patch(a, frame)) {
		*frame = a->sure;
		a->sure = NULL;
		frame_add_stage(*frame, "size", a->spent_us); // of the attempt that came to nothing
	}
	for (uint32_t i = 0; i < a->stage_count; i++)
		frame_add_stage(*frame, a->stages[i].name, a->stages[i].us);
	return STATUS_OK;
}

enum status attempts_read(struct attempts *a, struct frame **frame, struct error *err)
{
	struct frame *f;
	const bool scaled = attempts_scaled(a);
	enum status s = read_frame(a, &f, err);
	if (s == STATUS_OK && scaled) {
		f->estimate = ESTIMATE_UNKNOWN;
		frame_add_note(f, "there was time for %u x %u pixels alone: they are scaled, and their error is not known%s",
			       f->made_width, f->made_height,
			       a->plan->target_error > 0 ? ", so no target is known to be reached" : "");
		s = frame_scale(f, a->plan->width, a->plan->height, err);
		if (s != STATUS_OK)
			frame_destroy(f);
	}
	if (s == STATUS_OK)
		*frame = f;
	return s;
}

void attempts_end(struct attempts *a)
{
	if (a->work)
		a->technique->end(a->work);
	frame_destroy(a->sure);
	*a = (struct attempts){0};
}
