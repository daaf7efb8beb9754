// Design note. Each technique draws twice. The first picture is tiny: it compiles, uploads and builds what is missing, and
// tells about how long a sample takes. The second is as large as fits the budget with PILOT_SAMPLES samples; it is timed,
// and its error is measured.
#include "server/worker/pilot/pilot.h"

#include <math.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/stage.h"
#include "server/worker/image/frame.h"
#include "server/worker/plan/make.h"
#include "server/worker/scenes/resident.h"
#include "server/worker/technique/technique.h"

#define PILOT_SEED 0x70696c6f74ull // no request's by chance
#define PILOT_SAMPLES 16u
#define PILOT_SMOOTH 4u // samples of a technique without noise, so that edges are no part of its bias
#define PILOT_TINY 256u // pixels of the first picture
#define PILOT_LEAST 256u // of the second
#define PILOT_MOST 65536u
#define PILOT_SAMPLES_MOST 256u
#define PILOT_SLICE_US 20000u
#define PILOT_PATIENCE 8u // budgets that the work of one technique may take before it is given up

// One picture of a pilot.
struct drawing {
	struct frame *frame; // owned
	double cold_us, setup_us, pixel_us, sample_us, fixed_us;
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
	d->fixed_us = fmax(wall_us - all, 0);
}

// The request at about so many pixels, as wide for its height as it is.
static void make_small(const struct pilot *pilot, candil_Technique technique, double pixels, uint32_t samples,
		       candil_Render *render)
{
	*render = *pilot->render;
	const double scale = sqrt(pixels / ((double)render->width * render->height));
	render->width = (uint32_t)fmax(round(render->width * scale), 1);
	render->height = (uint32_t)fmax(round(render->height * scale), 1);
	render->technique = technique;
	render->samples = samples;
	render->first_sample = 0;
	render->seed = PILOT_SEED;
	render->aovs = 0;
	render->format = candil_Format_FORMAT_EXR_FLOAT;
	render->target_error = 0;
	render->deadline_ms = 0;
}

// Draw the request. STATUS_LIMIT: it was given up.
static enum status draw(const struct pilot *pilot, const candil_Render *render, struct drawing *out, struct error *err)
{
	struct plan plan;
	struct technique_job *job = NULL;
	struct step_result result = STEP_RESULT_NOTHING;
	*out = (struct drawing){0};
	enum status s =
	    plan_make(render, &pilot->scene->view, pilot->environment ? pilot->environment->blob : NULL, &plan, err);
	if (s != STATUS_OK)
		return s;
	plan.environment.scene = pilot->environment;
	const struct technique *t = technique_find(plan.technique);
	if (t->bytes(pilot->devices, pilot->scene, &plan) > pilot->memory)
		return error_set(err, STATUS_MEMORY, "a pilot does not fit");
	const uint64_t start = clock_us();
	s = t->begin(pilot->devices, pilot->scene, &plan, &job, err);
	const uint64_t begun = clock_us();
	while (s == STATUS_OK && !result.finished) {
		result = STEP_RESULT_NOTHING;
		s = t->step(job, PILOT_SLICE_US, &result, err);
		if (s == STATUS_OK && !result.finished && clock_us() - begun > (uint64_t)PILOT_PATIENCE * pilot->budget_us)
			s = error_set(err, STATUS_LIMIT, "a pilot takes too long");
	}
	if (s == STATUS_OK)
		s = t->read(job, &out->frame, err);
	t->end(job);
	if (s == STATUS_OK)
		add_up(out, (double)(clock_us() - start));
	return s;
}

struct estimate pilot_bias(const float *picture, const float *reference, uint64_t count, const struct estimate *noise)
{
	double sum = 0, squares = 0;
	const uint64_t pixels = count / 3;
	for (uint64_t p = 0; p < pixels; p++) {
		double term = 0;
		for (int c = 0; c < 3; c++) {
			const double r = (double)reference[3 * p + (uint64_t)c],
				     d = (double)picture[3 * p + (uint64_t)c] - r;
			term += d * d / (r * r + 0.01) / 3;
		}
		sum += term;
		squares += term * term;
	}
	if (pixels == 0 || !isfinite(squares) || noise->relmse < 0)
		return ESTIMATE_UNKNOWN;
	const double mean = sum / (double)pixels;
	const double spread = 1.645 * sqrt(fmax(squares / (double)pixels - mean * mean, 0) / (double)pixels);
	const double most = noise->high >= 0 ? noise->high : 3 * noise->relmse;
	return (struct estimate){.kind = candil_ErrorKind_ERROR_KIND_PREDICTED,
				 .relmse = fmax(mean - noise->relmse, 0),
				 .low = fmax(mean - spread - most, 0),
				 .high = mean + spread - fmin(noise->low, noise->relmse)};
}

// Look by one technique. `reference`: the picture of one with noise, and its error; frame NULL: there is none. *kept is the
// timed picture, the caller's.
static enum status look(const struct pilot *pilot, const struct technique *t, const struct drawing *reference,
			struct pilot_result *result, struct drawing *kept, struct error *err)
{
	const bool noisy = technique_traits(t->number) & TECHNIQUE_NOISE;
	const double asked = (double)pilot->render->width * pilot->render->height;
	candil_Render render;
	struct drawing first;
	make_small(pilot, t->number, fmin(PILOT_TINY, asked), noisy ? 2 : 1, &render);
	enum status s = draw(pilot, &render, &first, err);
	if (s != STATUS_OK)
		return s;
	const double tried = (double)render.width * render.height * render.samples;
	frame_destroy(first.frame);
	// The first picture's rate is too slow rather than too fast, and may have compiled. Of a technique without noise the
	// second picture is that of the reference.
	const double rate = fmax(first.sample_us / tried, 1e-4);
	uint32_t samples = PILOT_SMOOTH;
	double pixels = reference->frame ? (double)reference->frame->width * reference->frame->height : PILOT_LEAST * 16;
	if (noisy) {
		const double most = fmax(fmin(PILOT_MOST, asked / 4), fmin(PILOT_LEAST, asked));
		pixels = fmin(fmax(pilot->budget_us / (rate * PILOT_SAMPLES), PILOT_LEAST), most);
		samples = (uint32_t)fmin(fmax(pilot->budget_us / (rate * pixels), 4), PILOT_SAMPLES_MOST) & ~1u;
	}
	make_small(pilot, t->number, pixels, samples, &render);
	s = draw(pilot, &render, kept, err);
	if (s != STATUS_OK)
		return s;
	const double work = (double)render.width * render.height * kept->frame->samples;
	*result = (struct pilot_result){.pixels = render.width * render.height,
					.samples = kept->frame->samples,
					.cold_us = first.cold_us + fmax(first.sample_us - kept->sample_us * tried / work, 0),
					.setup_us = first.setup_us,
					.fixed_us = kept->fixed_us,
					.pixel_us = kept->pixel_us,
					.sample_us = kept->sample_us,
					.error = kept->frame->estimate};
	if (noisy)
		return STATUS_OK;
	result->error = ESTIMATE_UNKNOWN;
	if (reference->frame && reference->frame->width == kept->frame->width &&
	    reference->frame->height == kept->frame->height)
		result->error = pilot_bias(kept->frame->radiance, reference->frame->radiance, 3ull * result->pixels,
					   &reference->frame->estimate);
	return STATUS_OK;
}

static bool wanted(const struct pilot *pilot, const struct technique *t, bool noisy)
{
	return pilot->techniques >> t->number & 1u && ((technique_traits(t->number) & TECHNIQUE_NOISE) != 0) == noisy;
}

enum status pilot_run(const struct pilot *pilot, struct pilot_result results[TECHNIQUE_COUNT], struct error *err)
{
	struct drawing reference = {0};
	enum status s = STATUS_OK;
	memset(results, 0, TECHNIQUE_COUNT * sizeof *results);
	// Those with noise first: theirs is the reference.
	for (uint32_t i = 0; i < 2 * technique_count() && s != STATUS_DEVICE; i++) {
		const bool noisy = i < technique_count();
		const struct technique *t = technique_at(i % technique_count());
		struct drawing kept = {0};
		if (!wanted(pilot, t, noisy))
			continue;
		s = look(pilot, t, &reference, &results[t->number], &kept, err);
		if (s == STATUS_OK && noisy && !reference.frame)
			reference = kept;
		else
			frame_destroy(kept.frame);
	}
	frame_destroy(reference.frame);
	return s == STATUS_DEVICE ? s : STATUS_OK;
}
