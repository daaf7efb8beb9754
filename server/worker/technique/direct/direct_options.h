// Options of light straight from its source. Who stands on direct/lighting.h takes them too: its settings begin with these.
#ifndef CANDIL_WORKER_DIRECT_OPTIONS_H
#define CANDIL_WORKER_DIRECT_OPTIONS_H

#include "server/worker/plan/option.h"
#include "server/worker/plan/plan.h"

#define DIRECT_MAP_LEAST 256u

enum direct_shadows { DIRECT_SHADOWS_RAYS, DIRECT_SHADOWS_NONE, DIRECT_SHADOWS_MAP };

struct direct_settings {
	uint32_t points; // on lamps, for a pixel's sample
	uint32_t shadows; // enum direct_shadows
	uint32_t map; // texels of a shadow map's side
	uint32_t rows; // of pixels that are worked on at once; 0: as many as the device binds
};

// For an option_table of the technique's own list.
#define DIRECT_RULE_COUNT 4u
extern const struct option_rule direct_rules[DIRECT_RULE_COUNT];

void direct_options_default(void *settings);

// Of a plan of a technique whose settings begin with these.
static inline const struct direct_settings *direct_settings(const struct plan *plan)
{
	return (const struct direct_settings *)&plan->settings;
}

#endif
