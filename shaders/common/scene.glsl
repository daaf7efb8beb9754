// The resident scene, as every tracing pass sees it. Layouts: shared/layout.h.
#ifndef COMMON_SCENE_GLSL
#define COMMON_SCENE_GLSL

#include "shared/bindings.h"

layout(constant_id = SPEC_TEXTURES) const bool EFFECT_TEXTURES = true;
layout(constant_id = SPEC_EMITTERS) const bool EFFECT_EMITTERS = true;
layout(constant_id = SPEC_LIGHTS) const bool EFFECT_LIGHTS = true;
layout(constant_id = SPEC_ENVIRONMENT) const bool EFFECT_ENVIRONMENT = true;
layout(constant_id = SPEC_BOUNCES) const bool EFFECT_BOUNCES = true;

layout(std430, set = 0, binding = BIND_NODES) readonly buffer Nodes {
	vec4 nodes[];   // struct bvh_node, four words at a time
};
layout(constant_id = SPEC_GLOSSY) const bool EFFECT_GLOSSY = true;
layout(constant_id = SPEC_NORMAL_MAPS) const bool EFFECT_NORMAL_MAPS = true;
layout(constant_id = SPEC_ALPHA_MASK) const bool EFFECT_ALPHA_MASK = true;
layout(constant_id = SPEC_VERTEX_COLORS) const bool EFFECT_VERTEX_COLORS = true;
layout(constant_id = SPEC_UNLIT) const bool EFFECT_UNLIT = true;

layout(std430, set = 0, binding = BIND_LEAF_TRIANGLES) readonly buffer LeafTriangles {
	vec4 leaf_triangles[];   // struct leaf_triangle, likewise
};
layout(std430, set = 0, binding = BIND_TRIANGLES) readonly buffer Triangles {
	triangle triangles[];
};
layout(std430, set = 0, binding = BIND_VERTICES) readonly buffer Vertices {
	vertex vertices[];
};
layout(std430, set = 0, binding = BIND_MATERIALS) readonly buffer Materials {
	material materials[];
};
layout(std430, set = 0, binding = BIND_TEXTURES) readonly buffer Textures {
	texture_info textures[];
};
layout(std430, set = 0, binding = BIND_TEXELS) readonly buffer Texels {
	uint texels[];
};
layout(std430, set = 0, binding = BIND_EMITTERS) readonly buffer Emitters {
	emitter emitters[];
};
layout(std430, set = 0, binding = BIND_LIGHTS) readonly buffer Lights {
	punctual_light lights[];
};
layout(std430, set = 0, binding = BIND_SRGB_TABLE) readonly buffer SrgbTable {
	float srgb_table[];
};
layout(std430, set = 0, binding = BIND_UV1) readonly buffer Uv1 {
	vertex_uv1 uv1[];
};
layout(std430, set = 0, binding = BIND_COLORS) readonly buffer Colors {
	vertex_color colors[];
};
layout(std430, set = 0, binding = BIND_TANGENTS) readonly buffer Tangents {
	vertex_tangent tangents[];
};
layout(std430, set = 0, binding = BIND_GGX_TABLE) readonly buffer GgxTable {
	vec2 ggx_table[];
};
layout(std430, set = 0, binding = BIND_JOB) readonly buffer Job {
	pt_job job;
};

#define INFINITY uintBitsToFloat(0x7f800000u)

const float PI = 3.14159265358979323846;

vec3 to_vec3(float v[3])
{
	return vec3(v[0], v[1], v[2]);
}

#endif
