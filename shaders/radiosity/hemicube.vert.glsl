// Projects corners of triangles to the faces of hemicubes: an instance is a face of a cell, and the cell is found by layer.
// Clip space has depths 0 to w. Depth is NEAR / w, which keeps a float's precision at every distance, and NEAR is so little
// that the nearest plane cuts nothing off.
#version 450 core
#extension GL_GOOGLE_include_directive : require
#extension GL_ARB_shader_viewport_layer_array : require

#include "radiosity/hemicube.glsl"

#ifdef HEMICUBE_CUT
#include "radiosity/hemicube_scene.glsl"

layout(location = 0) out vec2 barycentric;
#endif

layout(location = 0) in vec3 position;
layout(location = 1) in uint instance; // cell · 8 + face
layout(location = 2) flat out uint id; // of the triangle, in its last corner
layout(binding = UNIT_HEMICUBE_CELLS) uniform samplerBuffer cells;
layout(location = HEMICUBE_NEAR) uniform float near;
#ifdef HEMICUBE_MIRRORED
layout(location = 1) flat out uint cell;
#endif

void main()
{
#ifdef HEMICUBE_CUT
	barycentric = vec2(gl_VertexID % 3 == 1, gl_VertexID % 3 == 2);
#endif
	id = uint(gl_VertexID) / 3u;
	uint i = instance >> 3;
	uint face = instance & 7u;
	int first = int(i) * HEMICUBE_CELL_TEXELS;
	vec3 p = position - texelFetch(cells, first).xyz;
	vec3 at = vec3(dot(p, texelFetch(cells, first + 1).xyz), dot(p, texelFetch(cells, first + 2).xyz),
		       dot(p, texelFetch(cells, first + 3).xyz));
	float w = face == 0u ? at.z : face == 1u ? at.x : face == 2u ? -at.x : face == 3u ? at.y : -at.y;
	vec2 xy = face == 0u ? at.xy : vec2(face <= 2u ? at.y : at.x, 2.0 * at.z - w);
	gl_Position = vec4(xy, near, w);
	gl_Layer = int(i * HEMICUBE_LAYERS + (face + 1u) / 2u);
#ifdef HEMICUBE_MIRRORED
	gl_ClipDistance[0] = dot(texelFetch(cells, first + 4), vec4(p, 1.0));
	cell = i;
#endif
}
