// Alpha during traversal. A ray passes a masked surface where its alpha is below the cutoff, and a blended surface of alpha
// a with probability 1 − a. The decision depends on the ray and the triangle alone, so both ways of walking the BVH see the
// same surfaces. The decisions of a pixel's samples at one triangle are a stratified set, and those at two triangles are sets
// that know nothing of each other, so the error falls as that of a path's other decisions.
#ifndef TRACE_ALPHA_GLSL
#define TRACE_ALPHA_GLSL

#include "common/sampling.glsl"
#include "common/texture.glsl"

// Seed of the random decisions of a pixel's rays at one event, and the index of the sample among them; set before the ray is
// traced. Seed 0: no randomness, a surface is present if its alpha is one half or more.
uint trace_chance = 0u;
uint trace_index = 0u;

// Whether the surface is present at this point of the triangle `id`; `index` is its material.
bool is_there(uint id, uint index, vec2 uv)
{
	material m = materials[index];
	if ((m.flags & (MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND)) == 0u)
		return true;
	triangle tri = triangles[id];
	vec3 bary = vec3(1.0 - uv.x - uv.y, uv);
	vec4 at = EFFECT_TEXTURES ? coordinates_at(tri, bary) : vec4(0.0);
	float chance = trace_chance == 0u ? 0.499999 : sample_2d(sampler_state(trace_index, trace_chance), id).x;
	return coverage_at(m, tri, bary, at) > chance;
}

#endif
