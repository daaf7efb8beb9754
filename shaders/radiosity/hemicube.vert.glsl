// Projects corners of triangles to the faces of hemicubes: an instance is a face of a cell, and the cell is found by layer and
// viewport. Clip space has depths 0 to w. Depth is NEAR / w, which keeps a float's precision at every
// distance, and NEAR is so little that the nearest plane cuts nothing off.
#version 450 core
#extension GL_GOOGLE_include_directive : require
#extension GL_ARB_shader_viewport_layer_array : require

#include "radiosity/hemicube.glsl"

#ifdef HEMICUBE_CUT
#include "radiosity/hemicube_scene.glsl"

layout(location = 0) out vec2 barycentric;
#else
layout(location = 0) in vec3 position;
#endif

layout(std430, binding = BIND_HEMICUBE_INSTANCES) readonly buffer Instances {
	uint instances[];
};
layout(location = HEMICUBE_DRAW) uniform uvec2 draw;
layout(location = HEMICUBE_NEAR) uniform float near;
#ifdef HEMICUBE_MIRRORED
layout(location = 1) flat out uint cell;
#endif

void main()
{
#ifdef HEMICUBE_CUT
	uint corner = uint(gl_VertexID);
	vec3 position = to_vec3(vertices[triangles[corner / 3u].vertex[corner % 3u]].position);
	barycentric = vec2(corner % 3u == 1u, corner % 3u == 2u);
#endif
	uint instance = instances[draw.y + uint(gl_InstanceID)];
	uint i = instance >> 3;
	uint face = instance & 7u;
	hemicube_cell c = hemicube_cells[i];
	vec3 p = position - hemicube_vec3(c.eye);
	vec3 at = vec3(dot(p, hemicube_vec3(c.x)), dot(p, hemicube_vec3(c.y)), dot(p, hemicube_vec3(c.z)));
	float w = face == 0u ? at.z : face == 1u ? at.x : face == 2u ? -at.x : face == 3u ? at.y : -at.y;
	vec2 xy = face == 0u ? at.xy : vec2(face <= 2u ? at.y : at.x, 2.0 * at.z - w);
	gl_Position = vec4(xy, near, w);
	gl_Layer = int(i / sizes.y);
	gl_ViewportIndex = int(i % sizes.y * HEMICUBE_FACES + face);
#ifdef HEMICUBE_MIRRORED
	gl_ClipDistance[0] = dot(vec3(c.clip[0], c.clip[1], c.clip[2]), p) + c.clip[3];
	cell = i;
#endif
}
