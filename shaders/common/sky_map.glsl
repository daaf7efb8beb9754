// The environment map as a camera ray or a narrow cone sees it, in the map's own unit.
#ifndef DIRECT_SKY_GLSL
#define DIRECT_SKY_GLSL

#include "common/sky_place.glsl"
#include "shared/sky.h"

layout(binding = SKY_PICTURE_UNIT) uniform sampler2D sky_picture;

vec3 sky_seen(vec3 w, float turn)
{
	return textureLod(sky_picture, sky_place(w, turn), 0.0).rgb;
}

#endif
