// A ray at a mirror.
#ifndef RADIOSITY_MIRROR_RAY_GLSL
#define RADIOSITY_MIRROR_RAY_GLSL

#include "common/surface.glsl"

// Turns a ray that has met triangle `c` at the barycentrics uv, at distance t, into the one that a mirror there sends on.
void mirror_reflect(corners c, vec2 uv, float t, inout vec3 origin, inout vec3 direction)
{
	vec3 p = point_met(c, uv, origin, direction, t);
	vec3 n = dot(c.normal, direction) < 0.0 ? c.normal : -c.normal;
	origin = p + start_offset(c, p) * n;
	direction = normalize(reflect(direction, n));
}

#endif
