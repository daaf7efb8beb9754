// The projection of a shadow map: struct shadow_map.
#ifndef DIRECT_SHADOW_VIEW_GLSL
#define DIRECT_SHADOW_VIEW_GLSL

#include "shared/shadow.h"

layout(std140, binding = UNIFORM_SHADOW_MAPS) uniform ShadowMaps {
	vec4 shadow_vectors[4 * SHADOW_MAPS_MAX];
};

struct shadow_view {
	vec3 eye;
	vec3 x;
	vec3 y;
	vec3 z;
	vec2 half_side;
	float near;
	float range;
	bool parallel;
};

shadow_view shadow_view_of(uint map)
{
	vec4 eye = shadow_vectors[4u * map];
	vec4 x = shadow_vectors[4u * map + 1u];
	vec4 y = shadow_vectors[4u * map + 2u];
	vec4 z = shadow_vectors[4u * map + 3u];
	return shadow_view(eye.xyz, x.xyz, y.xyz, z.xyz, vec2(x.w, y.w), eye.w, z.w, eye.w == 0.0);
}

// A position in the map's own axes, relative to its eye.
vec3 shadow_into(shadow_view v, vec3 position)
{
	vec3 d = position - v.eye;
	return vec3(dot(d, v.x), dot(d, v.y), dot(d, v.z));
}

float shadow_depth(shadow_view v, float away)
{
	return v.parallel ? 1.0 - away / v.range : v.near / max(away, v.near);
}

#endif
