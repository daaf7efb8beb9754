// The resident scene, as every tracing pass sees it. Layouts: shared/layout.h.
#ifndef COMMON_SCENE_GLSL
#define COMMON_SCENE_GLSL

#include "shared/bindings.h"
#include "shared/scene_params.h"

#include "common/pi.glsl"
#include "effects.glsl"

#ifdef VULKAN
#define SCENE_BUFFER(n) layout(std430, set = 0, binding = n)
layout(constant_id = SPEC_DEEP_TEXTURES) const bool DEEP_TEXTURES = false;
layout(constant_id = SPEC_RANGED_LIGHTS) const bool RANGED_LIGHTS = false;
layout(constant_id = SPEC_VAST_SCENE) const bool VAST_SCENE = false;
#else
#define SCENE_BUFFER(n) layout(std430, binding = n)
#ifndef DEEP_TEXTURES
#define DEEP_TEXTURES false
#endif
#ifndef RANGED_LIGHTS
#define RANGED_LIGHTS false
#endif
#ifndef VAST_SCENE
#define VAST_SCENE false
#endif
#endif

// Some OpenGL drivers count every declared block, used or not, against the sixteen that a stage may have. A program that
// needs other blocks leaves out some of these by defining SCENE_WITHOUT_TRACE, _LAMPS, _TANGENTS or _GGX.


#ifndef SCENE_WITHOUT_TRACE
#ifdef VULKAN
SCENE_BUFFER(BIND_NODES) readonly buffer Nodes {
	uvec4 nodes[];   // struct bvh_node, four words at a time
};
SCENE_BUFFER(BIND_LEAF_TRIANGLES) readonly buffer LeafTriangles {
	uvec4 leaf_triangles[];   // struct leaf_triangle, four words at a time
};
#define NODE_WORDS(i) nodes[i]
#define LEAF_WORDS(i) leaf_triangles[i]
#else
// OpenGL allows no more than sixteen storage blocks a stage, and software drivers fetch texels for all lanes at once.
layout(binding = UNIT_NODES) uniform usamplerBuffer node_words;
layout(binding = UNIT_LEAF_TRIANGLES) uniform usamplerBuffer leaf_words;
#define NODE_WORDS(i) texelFetch(node_words, int(i))
#define LEAF_WORDS(i) texelFetch(leaf_words, int(i))
#endif
#endif
SCENE_BUFFER(BIND_TRIANGLES) readonly buffer Triangles {
	triangle triangles[];
};
SCENE_BUFFER(BIND_VERTICES) readonly buffer Vertices {
	vertex vertices[];
};
SCENE_BUFFER(BIND_MATERIALS) readonly buffer Materials {
	material materials[];
};
SCENE_BUFFER(BIND_TEXTURES) readonly buffer Textures {
	texture_info textures[];
};
SCENE_BUFFER(BIND_TEXELS) readonly buffer Texels {
	uint texels[];
};
#ifndef SCENE_WITHOUT_LAMPS
SCENE_BUFFER(BIND_EMITTERS) readonly buffer Emitters {
	emitter emitters[];
};
SCENE_BUFFER(BIND_LIGHTS) readonly buffer Lights {
	punctual_light lights[];
};
#endif
SCENE_BUFFER(BIND_SRGB_TABLE) readonly buffer SrgbTable {
	float srgb_table[];
};
SCENE_BUFFER(BIND_UV1) readonly buffer Uv1 {
	vertex_uv1 uv1[];
};
SCENE_BUFFER(BIND_COLORS) readonly buffer Colors {
	vertex_color colors[];
};
#ifndef SCENE_WITHOUT_TANGENTS
SCENE_BUFFER(BIND_TANGENTS) readonly buffer Tangents {
	vertex_tangent tangents[];
};
#endif
#ifndef SCENE_WITHOUT_GGX
SCENE_BUFFER(BIND_GGX_TABLE) readonly buffer GgxTable {
	vec2 ggx_table[];
};
#endif
SCENE_BUFFER(BIND_JOB) readonly buffer Job {
	scene_params job;
};

#define INFINITY uintBitsToFloat(0x7f800000u)

// The share of a point or spot light that is left at the square `d2` of a distance, beside the square's law: Khronos,
// KHR_lights_punctual, "Range Property". 1 without a range.
float within_range(float range, float d2)
{
	float r2 = range * range;
	float share = d2 / r2;
	return RANGED_LIGHTS && range > 0.0 ? clamp(1.0 - share * share, 0.0, 1.0) : 1.0;
}

vec3 to_vec3(float v[3])
{
	return vec3(v[0], v[1], v[2]);
}

#endif
