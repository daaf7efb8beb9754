#include "server/worker/technique/direct/direct_options.h"

#define POINTS_DEFAULT 2u
#define MAP_DEFAULT 1024u

static const char *const shadows[] = {"rays", "none", "map", NULL};
static const char *const map_words[] = {"256", "512", "1024", "2048", "4096", NULL};
static const uint32_t map_sides[] = {DIRECT_MAP_LEAST, 512, MAP_DEFAULT, 2048, 4096};

const struct option_rule direct_rules[DIRECT_RULE_COUNT] = {
    OPTION_WHOLE("direct.samples", 1, LIMIT_DIRECT_SAMPLES, struct direct_settings, points),
    OPTION_WORD("direct.shadows", shadows, struct direct_settings, shadows),
    OPTION_NUMBER("direct.map", map_words, map_sides, struct direct_settings, map),
    OPTION_WHOLE("direct.rows", 0, LIMIT_SIDE, struct direct_settings, rows),
};

static bool maps(const struct plan *plan)
{
	return direct_settings(plan)->shadows == DIRECT_SHADOWS_MAP;
}

const struct option_need direct_needs[] = {{"direct.map", "direct.shadows=map", maps}, {0}};

void direct_options_default(void *settings)
{
	struct direct_settings *s = settings;
	s->points = POINTS_DEFAULT;
	s->map = MAP_DEFAULT;
}
