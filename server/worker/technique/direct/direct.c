#include "server/worker/technique/direct/direct.h"

#include <stdio.h>
#include <stdlib.h>

#include "server/worker/technique/common/scene_params.h"
#include "server/worker/technique/direct/direct_options.h"
#include "server/worker/technique/direct/lighting.h"
#include "server/worker/trace/trace.h"

struct technique_job {
	struct lighting lighting;
	struct deferred *deferred;
};

static const struct option_table options[] = {{direct_rules, DIRECT_RULE_COUNT, 0}, {0}};

static uint32_t direct_depth(const struct plan *plan)
{
	(void)plan;
	return 1;
}

static const char *direct_cannot(const struct plan *plan, candil_Effect effect)
{
	(void)plan;
	return effect == candil_Effect_EFFECT_CAUSTICS
		   ? "light that comes from lamps by way of polished surfaces is not followed"
		   : NULL;
}

static const char *direct_simulates(const struct plan *plan, candil_Effect effect)
{
	(void)plan;
	return effect == candil_Effect_EFFECT_ENVIRONMENT ? "the background is not black: it is seen, and lights nothing"
							  : NULL;
}

static struct lighting_wish wish_of(const struct plan *plan)
{
	const struct direct_settings *s = direct_settings(plan);
	struct lighting_wish wish = lighting_wish_of(s, s->shadows == DIRECT_SHADOWS_MAP, true);
	wish.dome = plan->default_light;
	return wish;
}

static uint64_t direct_bytes(const struct devices *devices, struct resident_scene *scene, const struct plan *plan)
{
	const struct lighting_wish wish = wish_of(plan);
	return deferred_bytes(devices, plan, wish.rows) + lighting_bytes(devices, scene, plan, &wish);
}

void direct_advise_map(uint64_t (*bytes)(const struct devices *devices, struct resident_scene *scene,
					 const struct plan *plan),
		       bool maps, const struct devices *devices, struct resident_scene *scene, const struct plan *plan,
		       uint64_t budget, char *advice)
{
	struct plan smaller = *plan;
	struct direct_settings *s = (struct direct_settings *)&smaller.settings;
	if (!maps)
		return;
	while (s->map > DIRECT_MAP_LEAST && bytes(devices, scene, &smaller) > budget)
		s->map /= 2;
	if (bytes(devices, scene, &smaller) <= budget)
		snprintf(advice, TECHNIQUE_ADVICE_BYTES, "direct.map=%u would fit", s->map);
}

static void direct_advise(const struct devices *devices, struct resident_scene *scene, const struct plan *plan,
			  uint64_t budget, char *advice)
{
	const bool maps = shadow_maps_wanted(plan, scene, wish_of(plan).map_side);
	direct_advise_map(direct_bytes, maps, devices, scene, plan, budget, advice);
}

static void direct_end(struct technique_job *job)
{
	if (!job)
		return;
	deferred_destroy(job->deferred);
	lighting_finish(&job->lighting);
	free(job);
}

static enum status direct_begin(struct devices *devices, struct resident_scene *scene, const struct plan *plan,
				struct technique_job **job, struct error *err)
{
	const struct lighting_wish wish = wish_of(plan);
	struct technique_job *j = calloc(1, sizeof *j);
	if (!j)
		return error_set(err, STATUS_MEMORY, "out of memory");
	struct lighting *l = &j->lighting;
	enum status s = lighting_init(l, devices, scene, plan, &wish, err);
	if (s == STATUS_OK)
		s = deferred_create(devices, scene, plan, wish.rows, TRACE_BINDINGS, l->passes, l->pass_count, &j->deferred,
				    err);
	if (s != STATUS_OK) {
		direct_end(j);
		return s;
	}
	deferred_add_setup(j->deferred, 0, l->compile_us);
	*job = j;
	return STATUS_OK;
}

static enum status direct_step(struct technique_job *job, uint32_t budget_us, struct step_result *result, struct error *err)
{
	struct lighting *l = &job->lighting;
	if (lighting_ready(l))
		return deferred_step(job->deferred, budget_us, result, err);
	return lighting_step(l, deferred_timer(job->deferred), budget_us, err);
}

static enum status direct_read(struct technique_job *job, struct frame **frame, struct error *err)
{
	return deferred_read(job->deferred, frame, err);
}

const struct technique technique_direct = {.number = candil_Technique_TECHNIQUE_DIRECT,
					   .options = options,
					   .needs = direct_needs,
					   .defaults = direct_options_default,
					   .depth = direct_depth,
					   .effects = DEFERRED_EFFECTS,
					   .cannot = direct_cannot,
					   .simulates = direct_simulates,
					   .sky_is_seen_alone = true,
					   .sides_are_code = true,
					   .bytes = direct_bytes,
					   .advise = direct_advise,
					   .begin = direct_begin,
					   .notes = deferred_notes,
					   .step = direct_step,
					   .read = direct_read,
					   .end = direct_end};
