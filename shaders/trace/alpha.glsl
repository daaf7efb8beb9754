// Where a masked material's alpha is below its cutoff, a ray goes on; where a blended one's is a, it does with probability
// 1 − a. That depends on the ray and the triangle alone, so both walks see the same.
#ifndef TRACE_ALPHA_GLSL
#define TRACE_ALPHA_GLSL

#include "common/sampling.glsl"
#include "common/texture.glsl"

// What a ray's chances come from: set before it is traced. 0: what is there by half or more is there.
uint trace_chance = 0u;

// Whether the surface is there at this point of a triangle.
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
