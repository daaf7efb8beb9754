// Visibility of a point, spot or directional light from its shadow map: the share of the texels around the receiver in
// which nothing is nearer to the light than the receiver's own plane.
//
// The plane's depth is linear over a map (shared/shadow.h), so each texel is compared with the plane's depth at the texel's
// own middle. However the surface is tilted, its own texels lie on that plane and need no slope bias. The remaining bias is
// a lift along the normal by SHADOW_LIFT texels, measured in metres at the receiver. The filter is a box of three texels'
// side about the receiver (percentage-closer filtering: Reeves, Salesin and Cook 1987).
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

// The receiver's plane in a map: its depth at `at` (in texels), and the change of depth per texel.
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
	// A plane seen edge-on has no finite slope; nor does it receive light.
	float facing = v.parallel ? min(n.z, -1e-3) * v.range : min(dot(n, q), -1e-3 * length(q)) / max(v.near, 1e-37);
	p.slope = v.half_side * n.xy / facing * (2.0 / side);
	return p;
}

// Visibility of four texels about the corner between them, in textureGather's order.
vec4 shadow_lit(shadow_plane p, vec2 corner, uint layer, float side)
{
	vec4 stored = textureGather(shadow_depths, vec3(corner / side, float(layer)));
	vec2 off = corner - p.at;
	vec4 plane = p.depth + p.slope.x * (off.x + vec4(-0.5, 0.5, 0.5, -0.5)) + p.slope.y * (off.y + vec4(0.5, 0.5, -0.5, -0.5));
	return vec4(lessThanEqual(stored, max(plane, 0.0)));
}

// Visibility of a light, 0…1. `first` is from shadow_first. `origin` is on the receiver, whose unit normal faces the light.
float shadow_map_open(uint first, vec3 origin, vec3 normal)
{
	uint layer = first & ~SHADOW_CUBE;
	if ((first & SHADOW_CUBE) != 0u)
		layer += shadow_face(origin - shadow_vectors[4u * layer].xyz);
	float side = float(textureSize(shadow_depths, 0).x);
	shadow_plane p = shadow_plane_of(shadow_view_of(layer), origin, normal, side);
	// A box of three texels' side covers four texels in each direction: the inner two entirely, the outer two in part.
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
