// The surface at a hit point: position, normals, material.
#ifndef COMMON_SURFACE_GLSL
#define COMMON_SURFACE_GLSL

#include "common/texture.glsl"

struct surface {
	vec3 position;
	vec3 geometric;     // unit; on the side that the ray came from
	vec3 shading;       // unit; on the same side of the triangle
	vec3 base;          // base colour, 0…1
	vec3 albedo;        // of the diffuse part, 0…1
	vec3 f0;            // microfacets' reflectance at normal incidence; with EFFECT_GLOSSY alone
	vec3 f90;           // and at grazing incidence; with EFFECT_GLOSSY alone
	float roughness;    // perceptual
	float diffuse_roughness;   // with EFFECT_ROUGH_DIFFUSE alone
	float coat;         // weight of the clear coat, 0…1; this and the two below with EFFECT_CLEARCOAT alone
	float coat_roughness;
	vec3 coat_normal;   // unit; on the side that the ray came from
	vec3 emission;      // radiance towards the origin of the ray, W/(m² sr)
	float emission_pdf; // density over area, 1/m², with which next-event estimation finds this point
	float offset;       // metres along `geometric` at which outgoing rays start
	bool unlit;         // shows `base` as radiance; nothing else of the material counts
	uint material;
	// The members below are set only with EFFECT_GLASS.
	bool front;         // the ray hit the front
	float transmission; // probability that the surface here is a clear boundary
	uint body;          // material + 1 of the clear body behind the surface, or 0
	bool thin;
	float ior;
	bool clear;         // this hit is a clear boundary; whoever makes the choice sets this and `eta`
	float eta;          // index of refraction on the far side divided by that on this side
};

// 16 half units in the last place of the corners' coordinates. It exceeds the rounding error of a point made from
// barycentrics and of the next intersection's translation together (Pharr, Jakob, Humphreys, "Physically Based Rendering",
// 3.9).
const float OFFSET_ERROR = 9.5367431640625e-07;

// A triangle's corners and its normal, world space, metres.
struct corners {
	vec3 v0;
	vec3 v1;
	vec3 v2;
	vec3 normal;       // unit, on the counter-clockwise side; zero if the triangle has no area
};

// The edges are first scaled to a size near 1: at 10¹⁰ metres, or at 10⁻¹⁵, their product would leave the range of a float.
vec3 unit_normal(vec3 v0, vec3 v1, vec3 v2)
{
	vec3 a = v1 - v0;
	vec3 b = v2 - v0;
	vec3 m = max(abs(a), abs(b));
	float k = 1.0 / max(max(m.x, max(m.y, m.z)), 1e-30);
	vec3 n = cross(a * k, b * k);
	float l = length(n);
	return l > 0.0 ? n / l : vec3(0.0);
}

corners corners_of(triangle tri)
{
	corners c;
	c.v0 = to_vec3(vertices[tri.vertex[0]].position);
	c.v1 = to_vec3(vertices[tri.vertex[1]].position);
	c.v2 = to_vec3(vertices[tri.vertex[2]].position);
	c.normal = unit_normal(c.v0, c.v1, c.v2);
	return c;
}

// The area, m²: half the length of the edges' cross product, scaled as in unit_normal.
float area_of(corners c)
{
	vec3 a = c.v1 - c.v0;
	vec3 b = c.v2 - c.v0;
	vec3 m = max(abs(a), abs(b));
	float size = max(max(m.x, max(m.y, m.z)), 1e-30);
	return 0.5 * length(cross(a / size, b / size)) * size * size;
}

// A bound of the rounding error of a position, in every direction, metres: it follows from the largest coordinate.
float position_error(corners c)
{
	vec3 m = max(abs(c.v0), max(abs(c.v1), abs(c.v2)));
	return OFFSET_ERROR * max(m.x, max(m.y, m.z));
}

// In a vast scene: a bound of what rounding does across a triangle's plane to the place q, and to its distance from the plane
// by plane_distance of trace/triangle.glsl, metres. Unlike position_error, it is next to nothing for a level floor, however
// wide, that is not high.
float plane_error(corners c, vec3 own, vec3 q)
{
	vec3 a = c.v1 - c.v0;
	vec3 b = c.v2 - c.v0;
	vec3 m = max(abs(a), abs(b));
	float k = 1.0 / max(max(m.x, max(m.y, m.z)), 1e-30);
	a *= k;
	b *= k;
	vec3 products = abs(a.yzx * b.zxy) + abs(a.zxy * b.yzx);
	return OFFSET_ERROR * (dot(abs(c.normal), own) + dot(products, abs(c.v0 - q)) / max(length(cross(a, b)), 1e-30));
}

// At what distance from a triangle, in metres along its normal, rays start that leave it at q.
float start_offset(corners c, vec3 q)
{
	float error = position_error(c);
	return VAST_SCENE ? min(error, plane_error(c, abs(q), q)) : error;
}

// How far off a triangle's plane, in metres, a segment from `origin` must end so as not to hit the triangle. It covers the
// rounding of the corners and of their translation to the origin, which the intersection begins with.
float segment_offset(corners c, vec3 origin)
{
	vec3 own = max(abs(c.v0), max(abs(c.v1), abs(c.v2)));
	vec3 reach = max(abs(c.v0 - origin), max(abs(c.v1 - origin), abs(c.v2 - origin)));
	float error = OFFSET_ERROR * (dot(abs(c.normal), own) + max(reach.x, max(reach.y, reach.z)));
	return VAST_SCENE ? min(error, plane_error(c, own, origin)) : error;
}

// The vector that moves p away from the edge a b, within the triangle's plane, if p is closer to it than `clearance`.
vec3 away_from_edge(vec3 p, vec3 a, vec3 b, vec3 normal, float clearance)
{
	vec3 inward = cross(normal, b - a);
	inward /= max(length(inward), 1e-30);
	return inward * clamp(clearance - dot(p - a, inward), 0.0, clearance);
}

// A point of the triangle, kept at least four rounding errors inside every edge. Rounding then cannot carry it through the
// wall on an edge's other side, which is how light leaks into closed rooms. It moves by only a few such errors.
vec3 point_inside(corners c, vec2 uv, float error)
{
	vec3 p = (1.0 - uv.x - uv.y) * c.v0 + uv.x * c.v1 + uv.y * c.v2;
	float clearance = 4.0 * error;
	return p + away_from_edge(p, c.v0, c.v1, c.normal, clearance) + away_from_edge(p, c.v1, c.v2, c.normal, clearance) +
	       away_from_edge(p, c.v2, c.v0, c.normal, clearance);
}

// Where a ray has hit a triangle. In a vast scene it is the ray's place at distance t, put onto the triangle's plane, if
// the ray is shorter than the triangle's coordinates: barycentrics of corners 10⁷ metres away are a metre uncertain.
vec3 point_met(corners c, vec2 uv, vec3 origin, vec3 direction, float t)
{
	vec3 p = origin + t * direction;
	vec3 own = max(abs(c.v0), max(abs(c.v1), abs(c.v2)));
	vec3 way = abs(origin) + t * abs(direction);
	if (VAST_SCENE && max(way.x, max(way.y, way.z)) < max(own.x, max(own.y, own.z)))
		return p - c.normal * dot(c.normal, p - c.v0);
	return point_inside(c, uv, position_error(c));
}

vec3 emission_at(material m, vec4 uv)
{
	vec3 e = to_vec3(m.emission);
	if (EFFECT_TEXTURES && m.emission_texture != NONE)
		e *= sample_texture(m.emission_texture, uv).rgb;
	return e;
}

float transmission_at(material m, vec4 uv)
{
	float t = m.transmission;
	if (EFFECT_TEXTURES && m.transmission_texture != NONE)
		t *= sample_texture(m.transmission_texture, uv).r;
	return t;
}

// KHR_materials_clearcoat: the coat's weight and its roughness.
vec2 coat_at(material m, vec4 uv)
{
	vec2 coat = vec2(m.coat, m.coat_roughness);
	if (EFFECT_TEXTURES && m.coat_texture != NONE)
		coat.x *= sample_texture(m.coat_texture, uv).r;
	if (EFFECT_TEXTURES && m.coat_roughness_texture != NONE)
		coat.y *= sample_texture(m.coat_roughness_texture, uv).g;
	return coat;
}

// Splits the base colour into diffuse albedo and microfacet reflectance: glTF 2.0, appendix B, and KHR_materials_specular.
void set_reflectance(inout surface s, material m, vec4 uv)
{
	s.albedo = s.base;
	if (!EFFECT_GLOSSY && !EFFECT_GLASS)
		return;
	float metallic = m.metallic;
	s.roughness = m.roughness;
	vec4 specular = vec4(to_vec3(m.specular), m.specular_weight);
	if (EFFECT_TEXTURES && m.surface_texture != NONE) {
		vec4 t = sample_texture(m.surface_texture, uv);
		s.roughness *= t.g;
		metallic *= t.b;
	}
	if (EFFECT_GLASS)
		s.transmission = transmission_at(m, uv) * (1.0 - metallic);
	if (!EFFECT_GLOSSY)
		return;
	if (EFFECT_TEXTURES && m.specular_texture != NONE)
		specular.rgb *= sample_texture(m.specular_texture, uv).rgb;
	if (EFFECT_TEXTURES && m.specular_weight_texture != NONE)
		specular *= sample_texture(m.specular_weight_texture, uv).a;
	s.f0 = mix(specular.rgb, s.base, metallic);
	s.f90 = mix(vec3(specular.w), vec3(1.0), metallic);
	s.albedo = s.base * (1.0 - metallic);
}

// The normal that a tangent-space map gives, on the side of `n`.
#ifndef SCENE_WITHOUT_TANGENTS
vec3 mapped_normal(uint map_texture, float scale, triangle tri, vec3 bary, vec4 uv, vec3 n)
{
	vec4 t = vec4(0.0);
	for (uint i = 0u; i < 3u; i++) {
		vertex_tangent k = tangents[tri.vertex[i]];
		t += bary[i] * vec4(k.xyzw[0], k.xyzw[1], k.xyzw[2], k.xyzw[3]);
	}
	vec3 along = t.xyz - dot(t.xyz, n) * n;
	float l = length(along);
	if (l < 1e-6)
		return n;
	along /= l;
	vec3 across = cross(n, along) * (t.w < 0.0 ? -1.0 : 1.0);
	vec3 map = sample_texture(map_texture, uv).xyz * 2.0 - 1.0;
	map.xy *= scale;
	return normalize(map.x * along + map.y * across + max(map.z, 1e-3) * n);
}
#else
vec3 mapped_normal(uint map_texture, float scale, triangle tri, vec3 bary, vec4 uv, vec3 n)
{
	return n;
}
#endif

// The mesh's own normal, on the front. Normal maps are relative to it.
vec3 mesh_normal(triangle tri, vec3 bary, vec3 geometric)
{
	vec3 n = vec3(0.0);
	for (uint i = 0u; i < 3u; i++)
		n += bary[i] * to_vec3(vertices[tri.vertex[i]].normal);
	float l = length(n);
	n = l > 1e-6 ? n / l : geometric;
	return dot(n, geometric) < 0.0 ? -n : n;
}

// The coat's normal; `n` is the mesh's own.
vec3 coat_normal_at(material m, triangle tri, vec3 bary, vec4 uv, vec3 n)
{
	bool mapped = EFFECT_NORMAL_MAPS && m.coat_normal_texture != NONE;
	return mapped ? mapped_normal(m.coat_normal_texture, m.coat_normal_scale, tri, bary, uv, n) : n;
}

// The surface that a ray hit: triangle `id` at the barycentrics uv, at distance t along the unit vector `direction`.
surface surface_at(uint id, vec2 uv, vec3 origin, vec3 direction, float t)
{
	triangle tri = triangles[id];
	material m = materials[tri.material];
	corners k = corners_of(tri);
	vec3 bary = vec3(1.0 - uv.x - uv.y, uv);
	surface s;
	s.position = point_met(k, uv, origin, direction, t);
	s.offset = start_offset(k, s.position);
	vec4 at = EFFECT_TEXTURES || EFFECT_NORMAL_MAPS ? coordinates_at(tri, bary) : vec4(0.0);

	bool front = dot(k.normal, direction) < 0.0;
	s.geometric = front ? k.normal : -k.normal;
	vec3 ns = mesh_normal(tri, bary, k.normal);
	if (EFFECT_CLEARCOAT) {
		vec3 nc = coat_normal_at(m, tri, bary, at, ns);
		vec2 coat = coat_at(m, at);
		s.coat_normal = front ? nc : -nc;
		s.coat = coat.x;
		s.coat_roughness = coat.y;
	}
	if (EFFECT_NORMAL_MAPS && m.normal_texture != NONE)
		ns = mapped_normal(m.normal_texture, m.normal_scale, tri, bary, at, ns);
	s.shading = front ? ns : -ns;

	s.base = clamp(base_color_at(m, tri, bary, at).rgb, 0.0, 1.0);
	s.f0 = vec3(0.0);
	s.f90 = vec3(0.0);
	s.roughness = 1.0;
	s.diffuse_roughness = EFFECT_ROUGH_DIFFUSE ? m.diffuse_roughness : 0.0;
	s.transmission = 0.0;
	set_reflectance(s, m, at);
	s.front = front;
	s.thin = (m.flags & MATERIAL_THIN) != 0u;
	s.ior = m.ior;
	s.body = EFFECT_GLASS && m.transmission > 0.0 && !s.thin ? tri.material + 1u : 0u;
	s.material = tri.material;
	s.clear = false;
	s.eta = 1.0;
	bool emits = front || (m.flags & MATERIAL_EMITS_BOTH_SIDES) != 0u;
	s.emission = EFFECT_EMITTERS && emits ? emission_at(m, at) : vec3(0.0);
	s.emission_pdf = m.power_density * job.emitter_power_inv * job.emitter_share;
	s.unlit = EFFECT_UNLIT && (m.flags & MATERIAL_UNLIT) != 0u;
	return s;
}

#endif
