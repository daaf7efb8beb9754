// The sampling techniques that a request may select for comparison: specialization constants, under the names by which the
// common files read them. Must be included before those.
#ifndef PATH_WAYS_GLSL
#define PATH_WAYS_GLSL

#include "shared/bindings.h"
#include "shared/pt.h"

layout(constant_id = SPEC_SAMPLER) const uint WAY_SAMPLER = SAMPLER_SOBOL;
layout(constant_id = SPEC_UNIFORM) const bool WAY_UNIFORM = false;
layout(constant_id = SPEC_LAMPS_BY) const uint WAY_LAMPS = LAMPS_BY_BOTH;
layout(constant_id = SPEC_ROULETTE) const bool WAY_ROULETTE = true;
layout(constant_id = SPEC_LIGHT_TREE) const bool WAY_LIGHT_TREE = false;
layout(constant_id = SPEC_CLAMP) const bool WAY_CLAMP = false;
layout(constant_id = SPEC_DISCS) const bool WAY_DISCS = false;
layout(constant_id = SPEC_EMITTER_CELLS) const bool WAY_EMITTER_CELLS = false;
layout(constant_id = SPEC_PRIORITIES) const bool PRIORITIES = false;

#define SAMPLES_INDEPENDENT (WAY_SAMPLER == SAMPLER_INDEPENDENT)
#define HEMISPHERE_UNIFORM WAY_UNIFORM
#define LAMPS_BY WAY_LAMPS
#define DISC_LIGHTS WAY_DISCS
#define LIGHT_TREE WAY_LIGHT_TREE
#define EMITTER_CELLS WAY_EMITTER_CELLS

#endif
