// The path tracer's options. README says what each does. Host only, any thread.
#ifndef CANDIL_WORKER_PT_OPTIONS_H
#define CANDIL_WORKER_PT_OPTIONS_H

#include "server/worker/plan/needs.h"
#include "server/worker/plan/option.h"
#include "server/worker/plan/plan.h"

// The words of pt.effect_times, pt.hemisphere, pt.light_tree and pt.roulette.
enum pt_effect_times { EFFECT_TIMES_OFF, EFFECT_TIMES_ON, EFFECT_TIMES_ALL };
enum pt_hemisphere { HEMISPHERE_COSINE, HEMISPHERE_UNIFORM };
enum pt_tree { LIGHT_TREE_AUTO, LIGHT_TREE_ON, LIGHT_TREE_OFF };
enum pt_roulette { ROULETTE_ON, ROULETTE_OFF };

struct constants; // vk/pipeline.h
struct scene_params; // shaders/shared/scene_params.h

// The values of the options.
struct pt_settings {
	uint32_t depth; // the most scattering events of a path
	uint32_t segment; // the most events in one dispatch; 0: as many as the device bears
	uint32_t batch; // samples in one dispatch; 0: chosen by measured speed
	uint32_t effect_times; // enum pt_effect_times: whether to measure first what each effect costs
	uint32_t traversal; // enum trace_way
	uint32_t sampler; // SAMPLER_…
	uint32_t hemisphere; // enum pt_hemisphere: how diffuse directions are sampled
	uint32_t lamps; // how light of surfaces is found: LAMPS_BY_… of shaders/shared/bindings.h
	uint32_t light_tree; // enum pt_tree
	uint32_t roulette; // enum pt_roulette
	float clamp; // of a sample's largest component, W/(m² sr); 0: none
};

// struct technique's `options`, `needs` and `defaults`.
extern const struct option_table pt_options[];
extern const struct option_need pt_needs[];
void pt_options_default(void *settings);

// How settings reach the shaders: the variant of a pass, and what of a job's parameters is the settings' own.
void pt_options_set_constants(const struct pt_settings *settings, struct constants *constants);
void pt_options_fill(const struct pt_settings *settings, struct scene_params *params);

// The settings in a plan of this technique.
static inline const struct pt_settings *pt_settings(const struct plan *plan)
{
	return (const struct pt_settings *)&plan->settings;
}

#endif
