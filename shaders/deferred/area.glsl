// The part of the image and the sample that a pass works on.
#ifndef DIRECT_AREA_GLSL
#define DIRECT_AREA_GLSL

#include "shared/deferred.h"

layout(location = DEFERRED_AREA) uniform uvec4 area;
layout(location = DEFERRED_SAMPLE) uniform uvec4 turn;
layout(location = DEFERRED_JITTER) uniform vec2 jitter;

#endif
