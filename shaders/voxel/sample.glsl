// What a triangle looks like within one cell: colours averaged over several points of the part that is inside.
#ifndef VOXEL_SAMPLE_GLSL
#define VOXEL_SAMPLE_GLSL

#include "voxel/grid.glsl"

struct look {
	vec3 albedo;       // of a Lambert surface that reflects as much as this one
	vec3 emission;     // radiance, W/(m² sr)
	float there;       // share that alpha leaves
};

const uint LOOK_SIDE_MAX = 4u;
const float LOOK_TEXELS = 4.0; // a point for so many texels along a side

// Barycentrics of a point over the columns, held to the triangle.
vec3 barycentrics(tile t, vec2 p, out bool inside)
{
	vec2 d = p - t.start.xy;
	float k = t.normal.z;
	vec2 uv = vec2(d.x * t.e2.y - d.y * t.e2.x, t.e1.x * d.y - t.e1.y * d.x) / (k != 0.0 ? k : 1.0);
	uv = k != 0.0 && !t.needle ? uv : vec2(1.0 / 3.0);
	inside = uv.x >= 0.0 && uv.y >= 0.0 && uv.x + uv.y <= 1.0;
	uv = clamp(uv, 0.0, 1.0);
	uv /= max(1.0, uv.x + uv.y);
	return vec3(1.0 - uv.x - uv.y, uv);
}

// Radiance that a surface gives away is diffuse here, so its specular part is too: Schlick's reflectance averaged over the
// hemisphere, F̄ = F0 + (F90 − F0) / 21, goes back at once, and the diffuse part has what is left. No more than 1 with either.
vec3 diffuse_albedo(material m, vec3 base, vec4 uv)
{
	surface s;
	s.base = base;
	s.f0 = vec3(0.0);
	s.f90 = vec3(0.0);
	s.roughness = 1.0;
	set_reflectance(s, m, uv);
	vec3 specular = clamp(mix(s.f0, s.f90, 1.0 / 21.0), 0.0, 1.0);
	return clamp(s.albedo * (1.0 - specular) + specular, 0.0, 1.0);
}

// Add a point's colours, by weight.
void add_point(inout look l, inout float points, material m, triangle tri, vec3 bary, float weight)
{
	vec4 uv = EFFECT_TEXTURES ? coordinates_at(tri, bary) : vec4(0.0);
	vec4 base = base_color_at(m, tri, bary, uv);
	bool cut = EFFECT_ALPHA_MASK && (m.flags & MATERIAL_ALPHA_MASK) != 0u && base.a < m.alpha_cutoff;
	float w = cut ? 0.0 : weight;
	points += weight;
	l.there += w;
	// Unlit surfaces neither reflect nor light anything.
	if (EFFECT_UNLIT && (m.flags & MATERIAL_UNLIT) != 0u)
		return;
	l.albedo += w * diffuse_albedo(m, clamp(base.rgb, 0.0, 1.0), uv);
	if (EFFECT_EMITTERS)
		l.emission += w * emission_at(m, uv);
}

// Texels of a material's largest texture along a voxel's side, the larger of both directions.
float texels_a_voxel(material m, triangle tri, tile t)
{
	uint chosen = m.albedo_texture != NONE ? m.albedo_texture : m.emission_texture != NONE ? m.emission_texture : m.surface_texture;
	if (chosen == NONE)
		return 0.0;
	texture_info info = textures[chosen];
	vec4 at0 = coordinates_at(tri, vec3(1.0, 0.0, 0.0));
	vec4 d1 = coordinates_at(tri, vec3(0.0, 1.0, 0.0)) - at0;
	vec4 d2 = coordinates_at(tri, vec3(0.0, 0.0, 1.0)) - at0;
	bool second = (info.flags & TEXTURE_UV1) != 0u;
	vec2 u1 = second ? d1.zw : d1.xy;
	vec2 u2 = second ? d2.zw : d2.xy;
	vec2 size = vec2(info.width, info.height);
	vec2 along1 = vec2(dot(vec2(info.row_u[0], info.row_u[1]), u1), dot(vec2(info.row_v[0], info.row_v[1]), u1)) * size;
	vec2 along2 = vec2(dot(vec2(info.row_u[0], info.row_u[1]), u2), dot(vec2(info.row_v[0], info.row_v[1]), u2)) * size;
	return max(length(along1) / max(length(t.e1), 1e-6), length(along2) / max(length(t.e2), 1e-6));
}

// Points along a side of the pattern; 0: the middle alone.
uint points_a_side(material m, triangle tri, tile t, float extent)
{
	if (!EFFECT_TEXTURES)
		return 0u;
	float texels = min(texels_a_voxel(m, tri, t) * extent, 1e4);
	return texels <= 1.5 ? 0u : clamp(uint(ceil(texels / LOOK_TEXELS)), 2u, LOOK_SIDE_MAX);
}

// Colours over the part of a triangle in a cell: a pattern of points over the part's box [low, high] (over the columns, from
// the cell's low corner), of which those count that are inside, and the centroid, `middle`, which always is.
look look_at(tile t, ivec3 cell, vec2 low, vec2 high, vec2 middle)
{
	look l = look(vec3(0.0), vec3(0.0), 0.0);
	triangle tri = triangles[t.id];
	material m = materials[tri.material];
	float points = 0.0;
	uint side = points_a_side(m, tri, t, max(high.x - low.x, high.y - low.y));
	bool inside;
	// The first round is the centroid.
	for (uint i = 0u; i < 1u + side * side; i++) {
		vec2 at = middle;
		if (i > 0u)
			at = low + (high - low) * (vec2((i - 1u) % side, (i - 1u) / side) + 0.5) / float(side);
		vec3 bary = barycentrics(t, at + vec2(cell.xy), inside);
		float h = t.start.z + bary.y * t.e1.z + bary.z * t.e2.z - float(cell.z);
		float weight = i == 0u ? 1.0 : inside && h >= 0.0 && h <= 1.0 ? 1.0 : 0.0;
		add_point(l, points, m, tri, bary, weight);
	}
	float there = max(l.there, 1e-6);
	l.albedo /= there;
	l.emission /= there;
	l.there /= points;
	return l;
}

#endif
