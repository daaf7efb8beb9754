// What a picture of radiosity needs of a place on the scene, as texels: software drivers fetch four words of them for all lanes
// in about the time of one word of a storage block.
#ifndef RADIOSITY_PLACE_GLSL
#define RADIOSITY_PLACE_GLSL

#include "common/surface.glsl"
#include "shared/radiosity_show.h"

layout(binding = RADIOSITY_CORNERS_UNIT) uniform usamplerBuffer place_triangles;
layout(binding = RADIOSITY_VERTICES_UNIT) uniform samplerBuffer place_vertices;
layout(binding = RADIOSITY_MATERIALS_UNIT) uniform usamplerBuffer place_materials;

struct place {
	uint id;          // triangle
	triangle tri;
	vec3 v0;          // its corners
	vec3 v1;
	vec3 v2;
	vec2 uv;          // barycentrics of corners 1 and 2
	float away;       // cosine between its normal and the ray that has met it
	bool front;       // it is seen from there
};

vec3 vertex_fetch(uint i)
{
	return texelFetch(place_vertices, 2 * int(i)).xyz;
}

// A triangle and its corners. The rest is the caller's to fill in.
place place_fetch(uint id)
{
	uvec4 w = texelFetch(place_triangles, int(id));
	place p;
	p.id = id;
	p.tri = triangle(uint[3](w.x, w.y, w.z), w.w);
	p.v0 = vertex_fetch(w.x);
	p.v1 = vertex_fetch(w.y);
	p.v2 = vertex_fetch(w.z);
	return p;
}

// Places it where a ray along `direction` has met it.
void place_met(inout place p, vec2 uv, vec3 direction)
{
	p.uv = uv;
	p.away = dot(unit_normal(p.v0, p.v1, p.v2), direction);
	p.front = p.away < 0.0;
}

// Of a material what is read here; the rest is undefined.
material material_fetch(uint i)
{
	int at = int(i) * RADIOSITY_MATERIAL_TEXELS;
	uvec4 base = texelFetch(place_materials, at);
	uvec4 emission = texelFetch(place_materials, at + 1);
	uvec4 gloss = texelFetch(place_materials, at + 3);
	material m;
	m.albedo = float[3](uintBitsToFloat(base.x), uintBitsToFloat(base.y), uintBitsToFloat(base.z));
	m.albedo_texture = base.w;
	m.emission = float[3](uintBitsToFloat(emission.x), uintBitsToFloat(emission.y), uintBitsToFloat(emission.z));
	m.emission_texture = emission.w;
	m.metallic = uintBitsToFloat(gloss.z);
	m.roughness = uintBitsToFloat(gloss.w);
	m.surface_texture = texelFetch(place_materials, at + 4).x;
	uvec4 sides = texelFetch(place_materials, at + 5);
	m.flags = sides.x;
	m.power_density = uintBitsToFloat(sides.y);
	return m;
}

// Both sets of texture coordinates, as coordinates_at.
vec4 place_coordinates(place p)
{
	vec4 uv = vec4(0.0);
	if (!EFFECT_TEXTURES)
		return uv;
	vec3 bary = vec3(1.0 - p.uv.x - p.uv.y, p.uv);
	for (uint i = 0u; i < 3u; i++) {
		uint v = p.tri.vertex[i];
		uv.xy += bary[i] * texelFetch(place_vertices, 2 * int(v) + 1).zw;
		if (job.has_uv1 != 0u)
			uv.zw += bary[i] * vec2(uv1[v].uv[0], uv1[v].uv[1]);
	}
	return uv;
}

#endif
