#include "server/worker/technique/pt/pt_effects.h"

#include <time.h>

#include "protocol/limits.h"
#include "server/base/clock.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/technique/pt/pt_job.h"
#include "server/worker/technique/pt/pt_light.h"
#include "server/worker/technique/pt/pt_options.h"
#include "server/worker/vk/command.h"

#define PROBE_TILES 64u // 4,096 pixels
#define PROBE_TURNS 3
#define PROBE_US (LIMIT_PROBE_SECONDS * 1000000ull) // no effect is begun after this: nobody else is served meanwhile

// A set of effects with its pipelines, ready to be timed.
struct contestant {
	struct pipeline *pipeline;
	struct binding_set bindings;
	struct pipeline *light; // with EFFECT_CAUSTICS
	struct binding_set light_bindings;
	double best_us; // least time of a sample of a tile, by the wall clock
	double best_work; // least work of it: the same time, or on a software device processor time
};

// A clock of the work done. On a software device it counts processor time, because the wall clock also counts what other
// processes do.
static double work_us(const struct technique_job *j)
{
	struct timespec t;
	if (!j->device->info.software || clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t) != 0)
		return (double)clock_us();
	return (double)t.tv_sec * 1e6 + (double)t.tv_nsec * 1e-3;
}

static double least_time(double a, double b)
{
	return a > 0 && a < b ? a : b;
}

static enum status prepare(struct technique_job *j, uint32_t effects, struct contestant *c, struct error *err)
{
	struct plan plan = j->plan;
	plan.effects = effects;
	enum status s = resident_upload(j->scene, j->device, scene_bindings_shade(&plan), err);
	if (s == STATUS_OK)
		s = pt_job_pipeline(j, effects, &c->pipeline, &c->bindings, err);
	if (s == STATUS_OK && plan_has(&plan, candil_Effect_EFFECT_CAUSTICS))
		s = pt_light_pipeline(j, effects, &c->light, &c->light_bindings, err);
	return s;
}

static void pt_effects_finish(struct technique_job *j, struct contestant *c)
{
	binding_set_finish(&c->bindings, j->device);
	binding_set_finish(&c->light_bindings, j->device);
}

// Trace one batch of the tiles in the middle of the first band, as a job does it.
static enum status trace(struct technique_job *j, struct contestant *c, struct error *err)
{
	const struct pt_band *band = &j->bands[0];
	const uint32_t tiles = band->tiles < PROBE_TILES ? band->tiles : PROBE_TILES;
	struct path_push push = pt_job_push(j, band);
	push.first_tile = band->first_tile + (band->tiles - tiles) / 2;
	push.tile_count = tiles;
	enum status s = command_begin(j->device, err);
	if (s != STATUS_OK)
		return s;
	pt_job_record(j, c->pipeline, &c->bindings, push, j->segments);
	if (c->light)
		pt_light_record(j, c->light, &c->light_bindings, band, push.first_tile, tiles);
	const uint64_t start = clock_us();
	const double before = work_us(j);
	s = command_finish(j->device, err);
	const double samples = (double)tiles * j->batch;
	c->best_work = least_time(c->best_work, (work_us(j) - before) / samples);
	c->best_us = least_time(c->best_us, (double)(clock_us() - start) / samples);
	return s;
}

// The first turn is not counted, because it meets cold caches.
static enum status race(struct technique_job *j, struct contestant *a, struct contestant *b, struct error *err)
{
	enum status s = STATUS_OK;
	for (int i = 0; s == STATUS_OK && i <= PROBE_TURNS; i++) {
		if (i == 1)
			a->best_us = b->best_us = a->best_work = b->best_work = 0;
		s = trace(j, a, err);
		if (s == STATUS_OK)
			s = trace(j, b, err);
	}
	return s;
}

static enum status time_one(struct technique_job *j, struct contestant *as_planned, candil_EffectReport *report,
			    struct error *err)
{
	const bool runs = plan_has(&j->plan, report->effect);
	struct contestant other = {0};
	enum status s = prepare(j, j->plan.effects ^ 1u << report->effect, &other, err);
	if (s == STATUS_OK)
		s = race(j, as_planned, &other, err);
	if (s == STATUS_OK) {
		const double more = other.best_work / as_planned->best_work - 1;
		report->has_cost_us = report->has_share = as_planned->best_work > 0;
		report->share = !report->has_share ? 0 : runs ? -more : more;
		report->cost_us = (int64_t)(report->share * as_planned->best_us * j->tiles * j->plan.samples);
	}
	pt_effects_finish(j, &other);
	return s;
}

// Caustics can be timed only in a job that has them: in others there is nothing of what light paths need.
static bool can_time(const struct technique_job *j, candil_Effect effect)
{
	return effect != candil_Effect_EFFECT_CAUSTICS || j->light;
}

enum status pt_time_effects(struct technique_job *j, candil_EffectReport *reports, uint32_t count, struct error *err)
{
	if (pt_settings(&j->plan)->effect_times == EFFECT_TIMES_OFF)
		return STATUS_OK;
	const uint64_t start = clock_us();
	struct contestant as_planned = {0};
	enum status s = prepare(j, j->plan.effects, &as_planned, err);
	// Effects that are simulated come first, in case time runs out.
	for (int pass = 0; pass < (pt_settings(&j->plan)->effect_times == EFFECT_TIMES_ALL ? 2 : 1); pass++)
		for (uint32_t i = 0; s == STATUS_OK && i < count && clock_us() - start < PROBE_US; i++)
			if (plan_has(&j->plan, reports[i].effect) == (pass == 0) && can_time(j, reports[i].effect))
				s = time_one(j, &as_planned, &reports[i], err);
	pt_effects_finish(j, &as_planned);
	j->effects_us = clock_us() - start;
	return s == STATUS_OK ? pt_job_restart(j, j->segment, j->batch_most, err) : s;
}
