#include "server/worker/technique/pt/pt_options.h"

#include "server/worker/trace/trace.h"
#include "server/worker/vk/pipeline.h"
#include "shaders/shared/pt.h"
#include "shaders/shared/scene_params.h"

#define DEPTH_DEFAULT 8u
#define BATCH_LIMIT 256u

_Static_assert(sizeof(struct pt_settings) <= PLAN_SETTINGS_BYTES, "the plan has room for them");

static const char *const effect_times[] = {"off", "on", "all", NULL};
static const char *const samplers[] = {"sobol", "independent", "blue", NULL};
static const char *const hemispheres[] = {"cosine", "uniform", NULL};
static const char *const lamp_ways[] = {"mis", "nee", "none", NULL};
static const char *const trees[] = {"auto", "on", "off", NULL};
static const char *const roulettes[] = {"on", "off", NULL};
static const char *const traversals[] = {[TRACE_AUTO] = "auto", [TRACE_SINGLE] = "single", [TRACE_PACKET] = "packet", NULL};

static const struct option_rule rules[] = {
    OPTION_WHOLE("pt.depth", 1, LIMIT_DEPTH, struct pt_settings, depth),
    OPTION_WHOLE("pt.segment", 1, LIMIT_DEPTH + 1, struct pt_settings, segment),
    OPTION_WHOLE("pt.batch", 1, BATCH_LIMIT, struct pt_settings, batch),
    OPTION_WORD("pt.effect_times", effect_times, struct pt_settings, effect_times),
    OPTION_WORD("pt.traversal", traversals, struct pt_settings, traversal),
    OPTION_WORD("pt.sampler", samplers, struct pt_settings, sampler),
    OPTION_WORD("pt.hemisphere", hemispheres, struct pt_settings, hemisphere),
    OPTION_WORD("pt.lights", lamp_ways, struct pt_settings, lamps),
    OPTION_WORD("pt.light_tree", trees, struct pt_settings, light_tree),
    OPTION_WORD("pt.roulette", roulettes, struct pt_settings, roulette),
    OPTION_REAL("pt.clamp", 0, LIMIT_RADIANCE, struct pt_settings, clamp),
};

const struct option_table pt_options[] = {{rules, sizeof rules / sizeof *rules, 0}, {0}};

static bool aims_at_lamps(const struct plan *plan)
{
	return pt_settings(plan)->lamps != LAMPS_BY_CHANCE;
}

const struct option_need pt_needs[] = {{"pt.light_tree", "pt.lights=mis or nee", aims_at_lamps}, {0}};

void pt_options_default(void *settings)
{
	struct pt_settings *s = settings;
	s->depth = DEPTH_DEFAULT;
}

void pt_options_set_constants(const struct pt_settings *s, struct constants *constants)
{
	constants_set(constants, SPEC_SAMPLER, s->sampler);
	constants_set(constants, SPEC_UNIFORM, s->hemisphere == HEMISPHERE_UNIFORM);
	constants_set(constants, SPEC_LAMPS_BY, s->lamps);
	constants_set(constants, SPEC_ROULETTE, s->roulette == ROULETTE_ON);
	constants_set(constants, SPEC_CLAMP, s->clamp > 0);
}

void pt_options_fill(const struct pt_settings *s, struct scene_params *params)
{
	params->clamp = s->clamp;
}
