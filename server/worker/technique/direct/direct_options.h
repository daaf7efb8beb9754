// Options of direct light. A technique that builds on direct/lighting.h takes them too: its settings begin with these.
#ifndef CANDIL_WORKER_DIRECT_OPTIONS_H
#define CANDIL_WORKER_DIRECT_OPTIONS_H

#include "server/worker/plan/needs.h"
#include "server/worker/plan/option.h"
#include "server/worker/plan/plan.h"

#define DIRECT_MAP_LEAST 256u // the smallest side of a shadow map, texels

// direct.shadows: by rays; none, so that every light reaches all that faces it; by shadow maps.
enum direct_shadows { DIRECT_SHADOWS_RAYS, DIRECT_SHADOWS_NONE, DIRECT_SHADOWS_MAP };

// The values of the options.
struct direct_settings {
	uint32_t points; // on emissive triangles, for a sample of a pixel: direct.samples
	uint32_t shadows; // enum direct_shadows
	uint32_t map; // texels of a shadow map's side
	uint32_t rows; // of pixels that are worked on at once; 0: as many as the device can bind
};

// The rules of the options, for an option_table in the technique's list.
#define DIRECT_RULE_COUNT 4u
extern const struct option_rule direct_rules[DIRECT_RULE_COUNT];

// What they need: struct technique's `needs` of direct itself.
extern const struct option_need direct_needs[];

// Fill in the defaults: struct technique's `defaults`.
void direct_options_default(void *settings);

// The settings in a plan of a technique whose settings begin with these.
static inline const struct direct_settings *direct_settings(const struct plan *plan)
{
	return (const struct direct_settings *)&plan->settings;
}

#endif
