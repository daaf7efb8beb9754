// Projects every corner of every triangle, fetched from the scene's buffers, to a light's shadow map. Clip space has depths
// 0 to w.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "common/scene.glsl"
#include "direct/shadow_view.glsl"

layout(location = SHADOW_LAYER) uniform uint layer;
layout(location = 0) out vec2 barycentric;

void main()
{
	uint corner = uint(gl_VertexID);
	shadow_view v = shadow_view_of(layer);
	vec3 p = shadow_into(v, to_vec3(vertices[triangles[corner / 3u].vertex[corner % 3u]].position));
	vec2 at = p.xy / v.half_side;
	barycentric = vec2(corner % 3u == 1u, corner % 3u == 2u);
	gl_Position = v.parallel ? vec4(at, shadow_depth(v, p.z), 1.0) : vec4(at, v.near, p.z);
}
