// Which triangle a pixel's ray meets first. Depth is that of the ray's own hit, not what the raster interpolates, so that
// surfaces that nearly touch come in the order that the path tracer sees, and of equal ones the lower id.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "deferred/visible.glsl"
#include "trace/alpha.glsl"

layout(location = DEFERRED_TRIANGLE) uniform uint first_triangle;
layout(location = 0) out uint visible;

void main()
{
	uint id = first_triangle + uint(gl_PrimitiveID);
	visible_point v = visible_ray(uvec2(gl_FragCoord.xy) + uvec2(0u, area.x));
	if (!visible_at(v, id) || (EFFECT_ALPHA_MASK && !is_there(id, triangles[id].material, v.uv)))
		discard;
	visible = id + 1u;
	// Grows towards the eye, and keeps a float's full precision at every distance.
	gl_FragDepth = min(VISIBLE_NEAR / v.t, 1.0);
}
