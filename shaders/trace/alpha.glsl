// Holes that a texture cuts: where a masked material's alpha is below its cutoff, a ray goes on.
#ifndef TRACE_ALPHA_GLSL
#define TRACE_ALPHA_GLSL

#include "common/texture.glsl"

// Whether the surface is there at this point of a triangle.
bool is_there(uint id, uint index, vec2 uv)
{
	material m = materials[index];
	if ((m.flags & MATERIAL_ALPHA_MASK) == 0u)
		return true;
	triangle tri = triangles[id];
	vec3 bary = vec3(1.0 - uv.x - uv.y, uv);
	vec4 at = EFFECT_TEXTURES ? coordinates_at(tri, bary) : vec4(0.0);
	return base_color_at(m, tri, bary, at).a >= m.alpha_cutoff;
}

#endif
