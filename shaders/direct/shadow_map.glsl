// What part of a point, spot or directional light arrives, out of its map: the share of the texels about the place in which
// nothing is nearer to the light than the receiver's own plane.
//
// The plane's depth is linear over a map (shared/shadow.h), so each texel is compared with the plane's depth at its own middle:
// however the surface leans, its own texels lie on that plane and need no bias for it. What bias remains is a lift along the
// normal by SHADOW_LIFT texels, in metres where the receiver is.
// Filter: a box of three texels' side about the place, over texels taken whole (percentage-closer filtering: Reeves,
// Salesin and Cook 1987).
#ifndef DIRECT_SHADOW_MAP_GLSL
#define DIRECT_SHADOW_MAP_GLSL

#include "direct/shadow_view.glsl"

layout(binding = SHADOW_MAPS_UNIT) uniform sampler2DArray shadow_depths;
layout(std430, binding = BIND_SHADOW_LIGHTS) readonly buffer ShadowLights {
	uint shadow_first[];
};

uint shadow_face(vec3 d)
{
	vec3 a = abs(d);
	uint axis = a.x >= a.y && a.x >= a.z ? 0u : a.y >= a.z ? 1u : 2u;
	return 2u * axis + (d[axis] < 0.0 ? 1u : 0u);
}

// A receiver's plane in a map: its depth at `at` (texels), and how that changes from texel to texel.
struct shadow_plane {
	vec2 at;
	float depth;
	vec2 slope;
};

shadow_plane shadow_plane_of(shadow_view v, vec3 origin, vec3 normal, float side)
{
	vec3 n = vec3(dot(normal, v.x), dot(normal, v.y), dot(normal, v.z));
	float texel = 2.0 * max(v.half_side.x, v.half_side.y) / side;
	vec3 q = shadow_into(v, origin);
	q += n * (SHADOW_LIFT * texel * (v.parallel ? 1.0 : max(q.z, 0.0)));
	vec2 ndc = q.xy / (v.half_side * (v.parallel ? 1.0 : max(q.z, v.near)));
	shadow_plane p;
	p.at = (ndc * 0.5 + 0.5) * side;
	p.depth = shadow_depth(v, q.z);
	// Seen from its edge a plane has no such numbers; nor does it get any light.
	float facing = v.parallel ? min(n.z, -1e-3) * v.range : min(dot(n, q), -1e-3 * length(q)) / max(v.near, 1e-37);
	p.slope = v.half_side * n.xy / facing * (2.0 / side);
	return p;
}

// Of four texels, textureGather's order about a corner between them.
vec4 shadow_lit(shadow_plane p, vec2 corner, uint layer, float side)
{
	vec4 stored = textureGather(shadow_depths, vec3(corner / side, float(layer)));
	vec2 off = corner - p.at;
	vec4 plane = p.depth + p.slope.x * (off.x + vec4(-0.5, 0.5, 0.5, -0.5)) + p.slope.y * (off.y + vec4(0.5, 0.5, -0.5, -0.5));
	return vec4(lessThanEqual(stored, max(plane, 0.0)));
}

// `first`: of shadow_first. `origin`: on the receiver, whose unit normal leans to the light.
float shadow_map_open(uint first, vec3 origin, vec3 normal)
{
	uint layer = first & ~SHADOW_CUBE;
	if ((first & SHADOW_CUBE) != 0u)
		layer += shadow_face(origin - shadow_vectors[4u * layer].xyz);
	float side = float(textureSize(shadow_depths, 0).x);
	shadow_plane p = shadow_plane_of(shadow_view_of(layer), origin, normal, side);
	// Three texels' side: the inner two of four whole, the outer ones as far as the box reaches.
	vec2 low = floor(p.at - 0.5);
	vec2 f = p.at - 0.5 - low;
	float sum = 0.0;
	for (uint k = 0u; k < 4u; k++) {
		vec2 high = vec2(k & 1u, k >> 1);
		vec4 lit = shadow_lit(p, low + 2.0 * high, layer, side);
		vec2 left = mix(1.0 - f, vec2(1.0), high);
		vec2 right = mix(vec2(1.0), f, high);
		sum += dot(lit, vec4(left.x, right.x, right.x, left.x) * vec4(right.y, right.y, left.y, left.y));
	}
	return sum * (1.0 / 9.0);
}

#endif
