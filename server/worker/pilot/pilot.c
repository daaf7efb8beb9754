// Design note. The first picture of a technique is tiny: it compiles, uploads and builds what is missing, and tells about
// how long a sample takes, if need be once more. The second is as large as fits the budget with PILOT_SAMPLES samples; it is
// timed, and its error is measured. A technique without noise has pictures for its error, as large as those that it is held
// to, and one for its time.
#include "server/worker/pilot/pilot.h"

#include <math.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/stage.h"
#include "server/worker/devices.h"
#include "server/worker/image/frame.h"
#include "server/worker/plan/make.h"
#include "server/worker/scenes/resident.h"
#include "server/worker/technique/technique.h"
#include "server/worker/vk/device.h"

#define PILOT_SEED 0x70696c6f74ull // no request's by chance
#define PILOT_SAMPLES 8u // of each of two halves
#define PILOT_SMOOTH 4u // samples of a technique without noise, for its bias without most of its edges
#define PILOT_TINY 256u // pixels of the first picture
#define PILOT_LEAST 256u // of the second
#define PILOT_MOST 65536u
#define PILOT_SAMPLES_LEAST 4u
#define PILOT_SAMPLES_MOST 256u
#define PILOT_OVERRUN 1.5 // budgets that the second picture may take
#define PILOT_DOUBT 4 // of a picture's time at least the pixels have one part in so many
#define PILOT_SLICE_US 20000u
#define BIAS_REACH 3u // pixels
#define BIAS_BRIGHT 4.0
#define PILOT_PATIENCE_US 10000000u // of one picture beside its work, past which it is given up: of compiling, of voxels

// One picture of a pilot.
struct drawing {
	struct frame *frame; // owned
	double cold_us, setup_us, pixel_us, sample_us;
	struct work work; // that it made; its time is not in setup_us
};

static void add_up(struct drawing *d, double wall_us)
{
	double all = 0;
	for (uint32_t i = 0; i < d->frame->stage_count; i++) {
		const double us = (double)d->frame->stages[i].us;
		all += us;
		switch (stage_kind(d->frame->stages[i].name)) {
		case STAGE_COLD:
			d->cold_us += us;
			break;
		case STAGE_SETUP:
			d->setup_us += us;
			break;
		case STAGE_PIXEL:
			d->pixel_us += us;
			break;
		default:
			d->sample_us += us;
		}
	}
	d->work = d->frame->work;
	d->setup_us = fmax(d->setup_us - work_us(&d->work), 0);
	// Of a frame it is `host`.
	d->pixel_us += fmax(wall_us - all, 0);
}

void pilot_request(const candil_Render *asked, const struct pilot_picture *picture, candil_Render *render)
{
	*render = *asked;
	const double scale = fmin(sqrt(picture->pixels / ((double)render->width * render->height)), 1);
	render->width = (uint32_t)fmax(round(render->width * scale), 1);
	render->height = (uint32_t)fmax(round(render->height * scale), 1);
	render->technique = picture->technique;
	render->options_count = 0;
	// What a reference makes its picture by is none of the request's.
	for (pb_size_t i = 0; i < asked->options_count; i++)
		if (technique_takes(picture->technique, asked->options[i].name))
			render->options[render->options_count++] = asked->options[i];
	if (!(technique_traits(picture->technique) & TECHNIQUE_PATCHES))
		render->imported[0] = '\0';
	render->samples = picture->samples;
	// More samples of one sequence would fill the gaps of the first: not independent of them.
	render->first_sample = 0;
	render->seed = PILOT_SEED + picture->half;
	render->aovs = 0;
	render->format = candil_Format_FORMAT_EXR_FLOAT;
	render->target_error = 0;
	render->deadline_ms = 0;
}

uint64_t pilot_patience_us(uint32_t budget_us)
{
	return PILOT_PATIENCE_US + (uint64_t)(PILOT_OVERRUN * budget_us);
}

static enum status plan_of(const struct pilot *pilot, const candil_Render *render, struct plan *plan, struct error *err)
{
	const struct blob_header *environment = pilot->environment ? pilot->environment->blob : NULL;
	// A reference by a technique without patches imports nothing.
	struct resident_scene *file = render->imported[0] ? pilot->imported : NULL;
	const enum status s = plan_make(render, &pilot->scene->view, environment, file ? file->blob : NULL, plan, err);
	plan->environment.scene = pilot->environment;
	plan->imported.scene = file;
	return s;
}

static bool is_over(const struct pilot *pilot)
{
	return clock_us() > pilot->end_us || pilot->is_ended(pilot->user);
}

// Draw the request. STATUS_LIMIT: it was given up.
static enum status draw(const struct pilot *pilot, const candil_Render *render, struct drawing *out, struct error *err)
{
	struct plan plan;
	struct technique_job *job = NULL;
	struct step_result result = STEP_RESULT_NOTHING;
	*out = (struct drawing){0};
	enum status s = plan_of(pilot, render, &plan, err);
	if (s != STATUS_OK)
		return s;
	const struct technique *t = technique_find(plan.technique);
	if (t->bytes(pilot->devices, pilot->scene, &plan) > pilot->memory)
		return error_set(err, STATUS_MEMORY, "a pilot does not fit");
	const uint64_t start = clock_us();
	if (is_over(pilot))
		return error_set(err, STATUS_LIMIT, "a pilot takes too long");
	do {
		pilot->devices->vk->wanted = 0;
		s = t->begin(pilot->devices, pilot->scene, &plan, &job, err);
	} while (s == STATUS_MEMORY && pilot->make_room(pilot->user));
	while (s == STATUS_OK && !result.finished) {
		result = STEP_RESULT_NOTHING;
		do {
			pilot->devices->vk->wanted = 0;
			s = t->step(job, PILOT_SLICE_US, &result, err);
		} while (s == STATUS_MEMORY && pilot->make_room(pilot->user));
		if (s == STATUS_OK && !result.finished &&
		    (is_over(pilot) || clock_us() - start > pilot_patience_us(pilot->budget_us)))
			s = error_set(err, STATUS_LIMIT, "a pilot takes too long");
	}
	if (s == STATUS_OK)
		s = t->read(job, &out->frame, err);
	t->end(job);
	if (s == STATUS_OK)
		add_up(out, (double)(clock_us() - start));
	return s;
}

// Of the pixels within BIAS_REACH of one, itself left out, the mean of a reference's channel, without the brightest: it may
// be a firefly.
static double mean_around(const struct pilot_reference *r, uint32_t x, uint32_t y, uint32_t c)
{
	double sum = 0, brightest = 0;
	unsigned count = 0;
	const uint32_t left = x > BIAS_REACH ? x - BIAS_REACH : 0, top = y > BIAS_REACH ? y - BIAS_REACH : 0;
	for (uint32_t v = top; v <= y + BIAS_REACH && v < r->height; v++)
		for (uint32_t u = left; u <= x + BIAS_REACH && u < r->width; u++) {
			const uint64_t at = 3 * ((uint64_t)v * r->width + u) + c;
			const double value = 0.5 * ((double)r->half[0][at] + (double)r->half[1][at]);
			if (u == x && v == y)
				continue;
			sum += value;
			count++;
			brightest = fmax(brightest, value);
		}
	return count > 1 ? (sum - brightest) / (count - 1) : 0;
}

// One pixel's term. Of halves that disagree neither is believed to be far brighter than what is around: one firefly would
// outweigh all other pixels.
static double bias_term(const float *picture, const struct pilot_reference *r, uint32_t x, uint32_t y)
{
	double term = 0;
	for (uint32_t c = 0; c < 3; c++) {
		const uint64_t at = 3 * ((uint64_t)y * r->width + x) + c;
		const double around = mean_around(r, x, y, c);
		double a = (double)r->half[0][at], b = (double)r->half[1][at], rho = (a + b + 2 * around) / 4;
		// Two that are black agree, too, but by chance, if there is light around.
		if (fabs(a - b) > 0.25 * (a + b) || a + b <= 0) {
			rho = around;
			a = fmin(a, BIAS_BRIGHT * rho);
			b = fmin(b, BIAS_BRIGHT * rho);
		}
		const double p = (double)picture[at];
		term += (p - a) * (p - b) / (rho * rho + 0.01) / 3;
	}
	return term;
}

struct estimate pilot_bias(const float *picture, const struct pilot_reference *r)
{
	double sum = 0, squares = 0;
	const double pixels = (double)r->width * r->height;
	for (uint32_t y = 0; y < r->height; y++)
		for (uint32_t x = 0; x < r->width; x++) {
			const double term = bias_term(picture, r, x, y);
			sum += term;
			squares += term * term;
		}
	if (!isfinite(squares))
		return ESTIMATE_UNKNOWN;
	const double mean = sum / pixels, spread = 1.645 * sqrt(fmax(squares / pixels - mean * mean, 0) / pixels);
	const double high = mean + spread;
	if (!(high > 0))
		return ESTIMATE_UNKNOWN;
	// A mean that its noise hides tells no more than an upper end.
	const double likely = fmax(mean, high / 4);
	return (struct estimate){.kind = candil_ErrorKind_ERROR_KIND_PREDICTED,
				 .relmse = likely,
				 .low = fmax(mean - spread, likely / 10),
				 .high = high};
}

// ---- a look ----------------------------------------------------------------------------------------------------------

struct estimate pilot_mean(const struct estimate *a, const struct estimate *b)
{
	if (a->relmse < 0 || b->relmse < 0)
		return a->relmse < 0 ? *b : *a;
	return (struct estimate){.kind = a->kind,
				 .relmse = (a->relmse + b->relmse) / 2,
				 .low = (a->low + b->low) / 2,
				 .high = a->high < 0 || b->high < 0 ? -1 : (a->high + b->high) / 2};
}

static struct pilot_result result_of(const struct drawing *d)
{
	return (struct pilot_result){.pixels = d->frame->width * d->frame->height,
				     .samples = d->frame->samples,
				     .slowed = d->cold_us > STAGE_COLD_US,
				     .pixel_us = d->pixel_us,
				     .sample_us = d->sample_us,
				     .error = d->frame->estimate};
}

// The second picture of a technique with noise, as two of half its samples: each is timed, and both are a reference.
static enum status look_twice(const struct pilot *pilot, const struct pilot_picture *picture, struct drawing halves[2],
			      struct pilot_result *result, struct error *err)
{
	enum status s = STATUS_OK;
	for (uint32_t i = 0; i < 2 && s == STATUS_OK; i++) {
		struct pilot_picture half = *picture;
		candil_Render render;
		half.half = i;
		pilot_request(pilot->render, &half, &render);
		s = draw(pilot, &render, &halves[i], err);
	}
	if (s != STATUS_OK)
		return s;
	*result = result_of(&halves[0]);
	result->pixel_us = (halves[0].pixel_us + halves[1].pixel_us) / 2;
	result->sample_us = (halves[0].sample_us + halves[1].sample_us) / 2;
	result->error = pilot_mean(&halves[0].frame->estimate, &halves[1].frame->estimate);
	return STATUS_OK;
}

// Once more, with other noise if it has any, what `result` has seen; its times are taken over.
static enum status look_again(const struct pilot *pilot, const struct pilot_picture *picture, struct pilot_result *result,
			      struct error *err)
{
	const struct estimate before = result->error;
	struct pilot_picture other = *picture;
	struct drawing d;
	candil_Render render;
	other.half = 1;
	pilot_request(pilot->render, &other, &render);
	const enum status s = draw(pilot, &render, &d, err);
	if (s != STATUS_OK)
		return s;
	*result = result_of(&d);
	result->error = pilot_mean(&before, &d.frame->estimate);
	frame_destroy(d.frame);
	return STATUS_OK;
}

// One picture of a technique without noise: its times, and its bias if there is a reference of its size.
static enum status look_once(const struct pilot *pilot, const struct pilot_picture *picture,
			     const struct drawing reference[2], struct pilot_result *result, struct pilot_bias *bias,
			     struct error *err)
{
	struct drawing d;
	candil_Render render;
	pilot_request(pilot->render, picture, &render);
	const enum status s = draw(pilot, &render, &d, err);
	if (s != STATUS_OK)
		return s;
	*result = result_of(&d);
	result->error = ESTIMATE_UNKNOWN;
	const struct frame *a = reference[0].frame, *b = reference[1].frame;
	// What is wrong with a diagram is no error.
	if (a && b && !d.frame->diagram && a->width == d.frame->width && a->height == d.frame->height) {
		const struct pilot_reference r = {a->width, a->height, {a->radiance, b->radiance}};
		*bias = (struct pilot_bias){result->pixels, result->samples, 0, pilot_bias(d.frame->radiance, &r)};
	}
	frame_destroy(d.frame);
	return STATUS_OK;
}

double pilot_sample_us(const double pixels[2], const double us[2], double asked)
{
	if (!(pixels[1] > pixels[0]))
		return us[1] / pixels[1] * asked;
	const double a_pixel = fmin(fmax((us[1] - us[0]) / (pixels[1] - pixels[0]), 0), us[1] / pixels[1]);
	return us[1] + a_pixel * (asked - pixels[1]);
}

// The second pictures of a technique with noise: as large and with as many samples as fit, by the rate of the first.
static enum status look_noisy(const struct pilot *pilot, struct pilot_picture picture, double rate,
			      struct drawing reference[2], struct pilot_result *result, struct error *err)
{
	struct drawing halves[2] = {{0}};
	const double asked = (double)pilot->render->width * pilot->render->height;
	const double most = fmax(fmin(PILOT_MOST, asked / 4), fmin(PILOT_LEAST, asked));
	const double paths = pilot->budget_us / (rate * 2); // of each half
	picture.pixels = fmin(fmax(paths / PILOT_SAMPLES, PILOT_LEAST), most);
	picture.samples = (uint32_t)fmin(fmax(paths / picture.pixels, PILOT_SAMPLES_LEAST), PILOT_SAMPLES_MOST);
	if (rate * 2 * picture.pixels * picture.samples > PILOT_OVERRUN * pilot->budget_us)
		return STATUS_OK; // so slow that the first has to do
	const enum status s = look_twice(pilot, &picture, halves, result, err);
	for (int i = 0; i < 2; i++)
		if (s == STATUS_OK && !reference[i].frame)
			reference[i] = halves[i];
		else
			frame_destroy(halves[i].frame);
	return s;
}

void pilot_edges(struct pilot_bias bias[2])
{
	const double many = bias[0].error.relmse, k = bias[0].samples, told = bias[1].error.relmse;
	if (!(k > 1) || bias[1].samples != 1 || !(many > 0) || !(told > 0))
		return;
	// One sample is no better than k and at most k times as far off; more than that is luck, of a lamp's rim say.
	const double one = fmin(fmax(told, many), k * many);
	bias[1].error.relmse = one;
	bias[1].error.low *= one / told;
	bias[1].error.high *= one / told;
	// The jitter of one sample has k times the variance of the mean of k.
	const double edges = fmin(fmax(one - many, 0) * k / (k - 1), one);
	bias[0].edges = fmin(edges / k / many, 1);
	bias[1].edges = edges / one;
}

// Those of another: as large as the reference, with few samples and with one, to see the bias; then one as large as fits,
// for the time. Each sample of a raster has a time that no pixel decides, so what a small one takes tells little of a large
// one.
static enum status look_clear(const struct pilot *pilot, struct pilot_picture picture, const struct drawing reference[2],
			      struct pilot_result *result, struct error *err)
{
	const double asked = (double)pilot->render->width * pilot->render->height;
	double pixels[2] = {result->pixels, result->pixels}, us[2] = {result->sample_us, result->sample_us};
	struct pilot_bias bias[2] = {{0}}, again; // of a large picture that is no larger
	enum status s = STATUS_OK;
	for (int i = 0; i < 2 && reference[0].frame && s == STATUS_OK; i++) {
		picture.pixels = (double)reference[0].frame->width * reference[0].frame->height;
		picture.samples = i == 0 ? PILOT_SMOOTH : 1;
		s = look_once(pilot, &picture, reference, result, &bias[i], err);
	}
	pilot_edges(bias);
	memcpy(result->bias, bias, sizeof bias);
	if (s != STATUS_OK)
		return s;
	pixels[1] = result->pixels;
	us[1] = result->sample_us;
	// By the two sizes so far, but for luck.
	const double one = pilot_sample_us(pixels, us, pixels[1] + 1) - us[1];
	const double a_pixel = fmax(fmax(one, us[1] / pixels[1] / PILOT_DOUBT), 1e-4);
	picture.samples = 1;
	picture.pixels = fmin(pixels[1] + fmax(pilot->budget_us - us[1], 0) / a_pixel, fmin(asked, PILOT_MOST));
	s = look_once(pilot, &picture, reference, result, &again, err);
	if (s != STATUS_OK)
		return s;
	memcpy(result->bias, bias, sizeof bias);
	pixels[0] = pixels[1];
	us[0] = us[1];
	pixels[1] = result->pixels;
	us[1] = result->sample_us;
	result->sample_us = pilot_sample_us(pixels, us, asked) / asked * result->pixels;
	return STATUS_OK;
}

// Look by one technique. `reference`: two pictures of one with noise, which is the first that looks; frames NULL: none yet.
static enum status look(const struct pilot *pilot, const struct technique *t, struct drawing reference[2],
			struct pilot_result *result, struct error *err)
{
	const bool noisy = technique_traits(t->number) & TECHNIQUE_NOISE;
	struct drawing first;
	candil_Render render;
	const struct pilot_picture tiny = {.technique = t->number, .pixels = PILOT_TINY, .samples = noisy ? 2 : 1};
	pilot_request(pilot->render, &tiny, &render);
	enum status s = draw(pilot, &render, &first, err);
	if (s != STATUS_OK)
		return s;
	const double tried = (double)render.width * render.height * render.samples;
	*result = result_of(&first);
	frame_destroy(first.frame);
	// Of what has compiled the samples were slow as well: their rate is asked again, or the second would be too small.
	if (first.cold_us > 0)
		s = look_again(pilot, &tiny, result, err);
	// What the first took more than the same again is compiling, too, of which the driver has not told.
	const double more = fmax(first.sample_us - result->sample_us, 0);
	if (s == STATUS_OK) {
		const double rate = fmax(result->sample_us / tried, 1e-4);
		s = noisy ? look_noisy(pilot, tiny, rate, reference, result, err)
			  : look_clear(pilot, tiny, reference, result, err);
	}
	result->cold_us = first.cold_us + more;
	result->setup_us = first.setup_us;
	result->work = first.work;
	return s;
}

// ---- work ------------------------------------------------------------------------------------------------------------

// What a technique's work will take about, by what was tried out of it.
static double foreseen_us(const struct work *w)
{
	double us = 0;
	for (int part = 0; part < WORK_PARTS; part++)
		us += w->made[part] > 0 ? w->left[part] * w->us[part] / w->made[part] : 0;
	return us;
}

static enum status foresee(const struct pilot *pilot, const struct technique *t, uint32_t try_us, struct work *work,
			   struct error *err)
{
	struct plan plan;
	candil_Render render = *pilot->render;
	enum status s = STATUS_OK;
	*work = (struct work){0};
	if (!t->foresee)
		return STATUS_OK;
	render.technique = t->number;
	render.target_error = 0;
	render.deadline_ms = 0;
	s = plan_of(pilot, &render, &plan, err);
	// What is tried out takes some of what a picture does.
	if (s == STATUS_OK && try_us > 0 && t->bytes(pilot->devices, pilot->scene, &plan) > pilot->memory)
		try_us = 0;
	if (s != STATUS_OK)
		return s;
	do {
		pilot->devices->vk->wanted = 0;
		s = t->foresee(pilot->devices, pilot->scene, &plan, try_us, work, err);
	} while (s == STATUS_MEMORY && pilot->make_room(pilot->user));
	return s;
}

// Tell the work that is left, and look as far as is wanted. Pictures whose work would not be done in time are not begun.
static enum status look_and_tell(const struct pilot *pilot, const struct technique *t, bool pictures,
				 struct drawing reference[2], struct pilot_result *result, struct error *err)
{
	struct work before, after;
	enum status s = foresee(pilot, t, pilot->try_us, &before, err);
	if (s == STATUS_OK && pictures && foreseen_us(&before) <= PILOT_PATIENCE_US)
		s = look(pilot, t, reference, result, err);
	else if (s == STATUS_OK)
		result->error = result->bias[0].error = result->bias[1].error = ESTIMATE_UNKNOWN;
	if (!before.told || s != STATUS_OK)
		return s;
	// A picture has made more of it than was tried out.
	const struct work made = result->work.told ? result->work : before;
	s = foresee(pilot, t, 0, &after, err);
	result->work = result->pixels > 0 ? after : before;
	for (int part = 0; part < WORK_PARTS; part++) {
		const struct work *most = made.made[part] > 0 ? &made : &before;
		result->work.made[part] = most->made[part];
		result->work.us[part] = most->us[part];
	}
	return s;
}

static bool wanted(const struct pilot *pilot, const struct technique *t, bool noisy)
{
	return (pilot->techniques | pilot->told) >> t->number & 1u &&
	       ((technique_traits(t->number) & TECHNIQUE_NOISE) != 0) == noisy;
}

static bool takes_all(int technique, const candil_Render *r)
{
	for (pb_size_t i = 0; i < r->options_count; i++)
		if (technique < 0 || !technique_takes((unsigned)technique, r->options[i].name))
			return false;
	return true;
}

// Whether the request can be planned at all: by its own technique, else by that of its options that takes them all.
static enum status look_over(const struct pilot *pilot, struct error *err)
{
	struct plan plan;
	candil_Render render = *pilot->render;
	for (pb_size_t i = 0; i < render.options_count && render.technique == candil_Technique_TECHNIQUE_AUTO; i++) {
		const int number = technique_number(render.options[i].name, strcspn(render.options[i].name, "."));
		render.technique = takes_all(number, &render) ? (candil_Technique)number : render.technique;
	}
	return plan_of(pilot, &render, &plan, err);
}

enum status pilot_run(const struct pilot *pilot, struct pilot_result results[TECHNIQUE_COUNT], uint32_t *cold,
		      struct error *err)
{
	struct drawing reference[2] = {{0}};
	memset(results, 0, TECHNIQUE_COUNT * sizeof *results);
	enum status s = look_over(pilot, err);
	if (s != STATUS_OK)
		return s;
	// Those with noise first: theirs is the reference.
	for (uint32_t i = 0; i < 2 * technique_count() && s != STATUS_DEVICE; i++) {
		const struct technique *t = technique_at(i % technique_count());
		if (!wanted(pilot, t, i < technique_count()))
			continue;
		s = look_and_tell(pilot, t, pilot->techniques >> t->number & 1u, reference, &results[t->number], err);
		if (s != STATUS_OK && pilot->devices->code.refused) {
			*cold = t->number;
			break;
		}
		// Time and memory may be there the next time, and are no word on the request.
		if (s != STATUS_OK && s != STATUS_LIMIT && s != STATUS_MEMORY && results[t->number].pixels == 0)
			results[t->number].refused = 1;
	}
	frame_destroy(reference[0].frame);
	frame_destroy(reference[1].frame);
	return s == STATUS_DEVICE || pilot->devices->code.refused ? s : STATUS_OK;
}
