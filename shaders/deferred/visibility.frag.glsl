// The triangle that a pixel's ray hits first. Depth is computed from the ray's own hit, not interpolated by the rasteriser.
// So surfaces that nearly touch come in the same order as in the path tracer; at equal depth the lower id wins.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "deferred/visible.glsl"
#include "trace/alpha.glsl"

layout(location = DEFERRED_TRIANGLE) uniform uint first_triangle;
layout(location = 0) out uint visible;

// Software drivers fetch texels for all lanes at once, and words of storage blocks lane by lane.
layout(binding = UNIT_TRIANGLES) uniform usamplerBuffer triangle_words;
layout(binding = UNIT_VERTICES) uniform samplerBuffer vertex_words;

vec3 corner_at(uint i)
{
	return texelFetch(vertex_words, 2 * int(i)).xyz;
}

void main()
{
	uint id = first_triangle + uint(gl_PrimitiveID);
	uvec3 corners = texelFetch(triangle_words, int(id)).xyz;
	visible_point v = visible_ray(uvec2(gl_FragCoord.xy) + uvec2(0u, area.x));
	if (!visible_on(v, id, corner_at(corners.x), corner_at(corners.y), corner_at(corners.z)) || (EFFECT_ALPHA_MASK && !is_there(id, triangles[id].material, v.uv)))
		discard;
	visible = id + 1u;
	// This depth grows towards the eye and keeps a float's full precision at every distance.
	gl_FragDepth = min(VISIBLE_NEAR / v.t, 1.0);
}
