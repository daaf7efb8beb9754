// The appearance of a triangle within one cell: colours averaged over several points of the part that is inside.
#ifndef VOXEL_SAMPLE_GLSL
#define VOXEL_SAMPLE_GLSL

#define TEXTURE_UNFILTERED true
#include "voxel/grid.glsl"

struct look {
	vec3 albedo;       // albedo of a Lambertian surface that reflects as much as this one
	vec3 emission;     // radiance, W/(m² sr)
	float there;       // share that remains after alpha masking and transmission
};

// With more texels than this along the longer side of a part, more points are sampled.
const float LOOK_TEXELS = 12.0;

// Barycentrics of a point over the columns, clamped to the triangle.
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

// The voxels' light is all diffuse, so the specular reflection is treated as diffuse too: the hemispherical mean of
// Schlick's reflectance, F̄ = F0 + (F90 − F0) / 21, is added to the diffuse albedo times what F̄ leaves. The sum is at most
// 1. Metalness and transmission are looked up once for all points, at `uv`; they change the sum little.
vec3 diffuse_albedo(material m, vec3 base, vec4 uv, out float transmission)
{
	surface s;
	s.base = base;
	s.f0 = vec3(0.0);
	s.f90 = vec3(0.0);
	s.roughness = 1.0;
	s.transmission = 0.0;
	set_reflectance(s, m, uv);
	transmission = s.transmission;
	vec3 specular = clamp(mix(s.f0, s.f90, 1.0 / 21.0), 0.0, 1.0);
	return clamp(s.albedo * (1.0 - specular) + specular, 0.0, 1.0);
}

// Adds a point's base colour and emission, by weight.
void add_point(inout look l, material m, triangle tri, vec3 bary, vec4 uv, float weight)
{
	vec4 base = base_color_at(m, tri, bary, uv);
	bool cut = EFFECT_ALPHA_MASK && (m.flags & MATERIAL_ALPHA_MASK) != 0u && base.a < m.alpha_cutoff;
	float w = cut ? 0.0 : weight;
	l.there += w;
	l.albedo += w * clamp(base.rgb, 0.0, 1.0);
	bool emits = EFFECT_EMITTERS && (m.emission[0] > 0.0 || m.emission[1] > 0.0 || m.emission[2] > 0.0);
	// A loop instead of an `if`, because some drivers execute the body of an `if` in any case.
	while (emits) {
		l.emission += w * emission_at(m, uv);
		emits = false;
	}
}

// Texture coordinates over a triangle, linear in the barycentrics of its second and third corner.
struct chart {
	vec4 at;
	vec4 d1;
	vec4 d2;
};

chart chart_of(triangle tri)
{
	chart c;
	c.at = coordinates_at(tri, vec3(1.0, 0.0, 0.0));
	c.d1 = coordinates_at(tri, vec3(0.0, 1.0, 0.0)) - c.at;
	c.d2 = coordinates_at(tri, vec3(0.0, 0.0, 1.0)) - c.at;
	return c;
}

// Texels of a material's first texture along a voxel's side, in the direction that has more.
float texels_a_voxel(material m, chart c, tile t)
{
	uint chosen = m.albedo_texture != NONE ? m.albedo_texture : m.emission_texture;
	if (chosen == NONE)
		return 0.0;
	texture_info info = textures[chosen];
	bool second = (info.flags & TEXTURE_UV1) != 0u;
	vec2 u1 = second ? c.d1.zw : c.d1.xy;
	vec2 u2 = second ? c.d2.zw : c.d2.xy;
	vec2 size = vec2(info.width, info.height);
	vec2 row_u = vec2(info.row_u[0], info.row_u[1]);
	vec2 row_v = vec2(info.row_v[0], info.row_v[1]);
	vec2 along1 = vec2(dot(row_u, u1), dot(row_v, u1)) * size;
	vec2 along2 = vec2(dot(row_u, u2), dot(row_v, u2)) * size;
	return max(length(along1) / max(length(t.e1), 1e-6), length(along2) / max(length(t.e2), 1e-6));
}

// Number of points along a side of the pattern; 0: the centroid alone.
uint points_a_side(float texels)
{
	return texels <= 1.5 ? 0u : texels <= LOOK_TEXELS ? 2u : 3u;
}

// Colours over the part of a triangle in a cell. Points are spread evenly over the part's box [low, high] (over the
// columns, from the cell's low corner); those inside the part count, and so does the centroid, `middle`, which is always
// inside. `seed` (0 … 1) moves the points within their strata, to avoid resonance with a texture that repeats (Roberts
// 2018's sequence R2).
look look_at(tile t, ivec3 cell, vec2 low, vec2 high, vec2 middle, float seed)
{
	look l = look(vec3(0.0), vec3(0.0), 0.0);
	triangle tri = triangles[t.id];
	material m = materials[tri.material];
	float points = 0.0;
	chart c = chart(vec4(0.0), vec4(0.0), vec4(0.0));
	uint side = 0u;
	if (EFFECT_TEXTURES) {
		c = chart_of(tri);
		side = points_a_side(texels_a_voxel(m, c, t) * max(high.x - low.x, high.y - low.y));
	}
	vec4 uv = vec4(0.0);
	// The last round is for the centroid.
	for (uint i = 0u; i <= side * side; i++) {
		bool last = i == side * side;
		vec2 within = fract(seed + float(i) * vec2(0.75487767, 0.56984029));
		vec2 at = last ? middle : low + (high - low) * (vec2(i % side, i / side) + within) / float(side);
		bool inside;
		vec3 bary = barycentrics(t, at + vec2(cell.xy), inside);
		float h = t.start.z + bary.y * t.e1.z + bary.z * t.e2.z - float(cell.z);
		float weight = last || (inside && h >= 0.0 && h <= 1.0) ? 1.0 : 0.0;
		uv = c.at + bary.y * c.d1 + bary.z * c.d2;
		points += weight;
		add_point(l, m, tri, bary, uv, weight);
	}
	float there = max(l.there, 1e-6);
	float transmission;
	l.albedo = diffuse_albedo(m, l.albedo / there, uv, transmission);
	l.emission /= there;
	l.there /= points;
	if (EFFECT_GLASS)
		l.there *= 1.0 - transmission;
	// Unlit surfaces neither reflect light nor light anything.
	if (EFFECT_UNLIT && (m.flags & MATERIAL_UNLIT) != 0u) {
		l.albedo = vec3(0.0);
		l.emission = vec3(0.0);
	}
	return l;
}

#endif
