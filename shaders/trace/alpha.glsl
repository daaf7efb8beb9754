// Alpha during traversal. A ray passes a masked surface where its alpha is below the cutoff, and a blended surface of alpha
// a with probability 1 − a. The decision depends on the ray and the triangle alone, so both ways of walking the BVH see the
// same surfaces.
#ifndef TRACE_ALPHA_GLSL
#define TRACE_ALPHA_GLSL

#include "common/sampling.glsl"
#include "common/texture.glsl"

// Seed of a ray's random decisions; set before the ray is traced. 0: no randomness, a surface is present if its alpha is
// one half or more.
uint trace_chance = 0u;

// Whether the surface is present at this point of the triangle `id`; `index` is its material.
bool is_there(uint id, uint index, vec2 uv)
{
	material m = materials[index];
	if ((m.flags & (MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND)) == 0u)
		return true;
	triangle tri = triangles[id];
	vec3 bary = vec3(1.0 - uv.x - uv.y, uv);
	vec4 at = EFFECT_TEXTURES ? coordinates_at(tri, bary) : vec4(0.0);
	float chance = float(hash_combine(trace_chance, id) >> 8) * UNIT_24;
	chance = trace_chance == 0u ? 0.499999 : chance;
	return coverage_at(m, tri, bary, at) > chance;
}

#endif
