// What a ray met: position, normals, colours.
#ifndef COMMON_SURFACE_GLSL
#define COMMON_SURFACE_GLSL

#include "common/texture.glsl"

struct surface {
	vec3 position;
	vec3 geometric;     // unit, on the side that the ray came from
	vec3 shading;       // unit, on the same side of the triangle
	vec3 albedo;        // 0…1
	vec3 emission;      // radiance towards where the ray came from, W/(m² sr)
	float emission_pdf; // next-event estimation finds this point with this density over area, 1/m²
	float offset;       // metres: rays start this far off along `geometric`
};

// 16 half units in the last place of the corners' coordinates: more than the rounding of a point made from barycentrics
// and of the next intersection's translation together (Pharr, Jakob, Humphreys, "Physically Based Rendering", 3.9).
const float OFFSET_ERROR = 9.5367431640625e-07;

// Distance at which a point made from these corners is safely off their plane.
float surface_offset(vec3 v0, vec3 v1, vec3 v2, vec3 n)
{
	return OFFSET_ERROR * dot(abs(n), max(abs(v0), max(abs(v1), abs(v2))));
}

// Barycentrics moved towards the middle so that the point keeps four offsets away from every edge: rounding can then not
// carry it through the wall on an edge's other side, which is how light leaks into closed rooms.
vec3 inside_edges(vec2 uv, float clearance, vec3 v0, vec3 v1, vec3 v2, float twice_area)
{
	vec3 edges = vec3(length(v2 - v1), length(v0 - v2), length(v1 - v0));
	vec3 margin = 4.0 * clearance / max(twice_area, 1e-37) * edges;
	float sum = margin.x + margin.y + margin.z;
	vec3 b = vec3(1.0 - uv.x - uv.y, uv.x, uv.y);
	return sum < 1.0 ? margin + (1.0 - sum) * b : vec3(1.0 / 3.0);
}

// The greatest coordinate bounds the rounding error of a position in every direction.
float position_error(vec3 v0, vec3 v1, vec3 v2)
{
	vec3 m = max(abs(v0), max(abs(v1), abs(v2)));
	return OFFSET_ERROR * max(m.x, max(m.y, m.z));
}

vec3 emission_at(material m, vec2 uv)
{
	vec3 e = to_vec3(m.emission);
	if (EFFECT_TEXTURES && m.emission_texture != NONE)
		e *= sample_texture(m.emission_texture, uv).rgb;
	return e;
}

vec3 albedo_at(material m, vec2 uv)
{
	vec3 a = to_vec3(m.albedo);
	if (EFFECT_TEXTURES && m.albedo_texture != NONE)
		a *= sample_texture(m.albedo_texture, uv).rgb;
	return clamp(a, 0.0, 1.0);
}

surface surface_at(uint id, vec2 uv, vec3 direction)
{
	triangle tri = triangles[id];
	vertex a = vertices[tri.vertex[0]];
	vertex b = vertices[tri.vertex[1]];
	vertex c = vertices[tri.vertex[2]];
	material m = materials[tri.material];
	vec3 v0 = to_vec3(a.position);
	vec3 v1 = to_vec3(b.position);
	vec3 v2 = to_vec3(c.position);

	vec3 cross_edges = cross(v1 - v0, v2 - v0);
	float twice_area = length(cross_edges);
	surface s;
	vec3 n = cross_edges / max(twice_area, 1e-37);
	bool front = dot(n, direction) < 0.0;

	float error = position_error(v0, v1, v2);
	vec3 bary = inside_edges(uv, error, v0, v1, v2, twice_area);
	s.position = bary.x * v0 + bary.y * v1 + bary.z * v2;
	s.offset = error;

	s.geometric = front ? n : -n;
	vec3 ns = bary.x * to_vec3(a.normal) + bary.y * to_vec3(b.normal) + bary.z * to_vec3(c.normal);
	float ns_length = length(ns);
	ns = ns_length > 1e-6 ? ns / ns_length : s.geometric;
	s.shading = dot(ns, s.geometric) < 0.0 ? -ns : ns;

	vec2 at = vec2(0.0);
	if (EFFECT_TEXTURES)
		at = bary.x * vec2(a.uv[0], a.uv[1]) + bary.y * vec2(b.uv[0], b.uv[1]) + bary.z * vec2(c.uv[0], c.uv[1]);
	s.albedo = albedo_at(m, at);
	bool emits = front || (m.flags & MATERIAL_EMITS_BOTH_SIDES) != 0u;
	s.emission = EFFECT_EMITTERS && emits ? emission_at(m, at) : vec3(0.0);
	s.emission_pdf = m.power_density * job.emitter_power_inv * job.emitter_share;
	return s;
}

#endif
