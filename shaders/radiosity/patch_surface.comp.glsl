// What patches are made of: means over their points of what surface_at says, an invocation a patch.
//
// Radiosity knows two kinds of reflection, Lambert's and the mirror's. A polished metal is a mirror. All else is Lambert's, of
// its base colour: metals that are not polished, glass, and dielectrics, whose specular lobe is left out.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "common/surface.glsl"
#include "shared/patch_pass.h"

layout(local_size_x = PATCH_GROUP) in;

layout(constant_id = SPEC_PATCH_COUNT) const uint PATCH_COUNT = 0u;

layout(push_constant) uniform Push {
	patch_push push;
};
layout(std430, set = 0, binding = BIND_RADIOSITY_SURFACES) writeonly buffer Surfaces {
	radiosity_surface radiosity_surfaces[];
};
#include "radiosity/patch_point.glsl"

// The area, in texels, of a part `share` of a triangle in a texture, with a margin for what is narrow; 0 for none.
float texels_under(uint index, triangle tri, float share)
{
	if (!EFFECT_TEXTURES || index == NONE)
		return 0.0;
	texture_info t = textures[index];
	vec2 p[3];
	for (uint i = 0u; i < 3u; i++) {
		vec4 uv = coordinates_at(tri, vec3(i == 0u, i == 1u, i == 2u));
		vec3 set = vec3((t.flags & TEXTURE_UV1) != 0u ? uv.zw : uv.xy, 1.0);
		p[i] = vec2(dot(to_vec3(t.row_u), set), dot(to_vec3(t.row_v), set)) * vec2(t.width, t.height);
	}
	vec2 a = p[1] - p[0], b = p[2] - p[0];
	float side = sqrt(min(share, 1.0));
	float area = share * 0.5 * abs(a.x * b.y - a.y * b.x) + side * (length(a) + length(b));
	return (t.flags & TEXTURE_NEAREST) != 0u ? max(area, PATCH_TEXELS_NEAREST) : area;
}

bool colours_vary(triangle tri)
{
	if (!EFFECT_VERTEX_COLORS || job.has_colors == 0u)
		return false;
	bool vary = false;
	for (uint i = 1u; i < 3u; i++)
		for (uint c = 0u; c < 4u; c++)
			vary = vary || colors[tri.vertex[0]].rgba[c] != colors[tri.vertex[i]].rgba[c];
	return vary;
}

// How many points are looked at.
uint points_of(radiosity_patch p)
{
	uvec2 ids = patch_triangles[p.face];
	uint texels = 0u;
	bool vary = false;
	bool textured = false;
	vec4 first = vec4(0.0);
	for (uint k = 0u; k < 2u; k++) {
		if (ids[k] == NONE)
			break;
		triangle tri = triangles[ids[k]];
		material m = materials[tri.material];
		float share = p.area / max(area_of(corners_of(tri)), 1e-30);
		float most = max(texels_under(m.albedo_texture, tri, share), texels_under(m.emission_texture, tri, share));
		if (EFFECT_GLOSSY)
			most = max(most, texels_under(m.surface_texture, tri, share));
		textured = textured || (EFFECT_TEXTURES && (m.albedo_texture != NONE || m.emission_texture != NONE ||
							    (EFFECT_GLOSSY && m.surface_texture != NONE)));
		// Written as a comparison that a NaN fails.
		texels = max(texels, most < float(PATCH_POINTS_MOST) ? uint(most) : PATCH_POINTS_MOST);
		vary = vary || colours_vary(tri);
		if (EFFECT_VERTEX_COLORS && job.has_colors != 0u) {
			float rgba[4] = colors[tri.vertex[0]].rgba;
			vec4 c = vec4(rgba[0], rgba[1], rgba[2], rgba[3]);
			vary = vary || (k == 1u && c != first);
			first = c;
		}
	}
	if (!textured)
		return vary ? PATCH_POINTS_COLOURED : 1u;
	uint wanted = clamp(texels * PATCH_POINTS_TEXEL, PATCH_POINTS_TEXTURED, PATCH_POINTS_MOST);
	return 1u << (findMSB(wanted - 1u) + 1);
}

// Sums over the points, by the area that is there.
struct sums {
	vec3 emission;
	vec3 albedo;
	vec3 mirror;
	float there;
	float area;
};

void look_at(inout sums sum, patch_point p)
{
	triangle tri = triangles[p.id];
	material m = materials[tri.material];
	vec3 bary = vec3(1.0 - p.uv.x - p.uv.y, p.uv);
	vec4 at = EFFECT_TEXTURES ? coordinates_at(tri, bary) : vec4(0.0);
	float weight = p.weight * coverage_at(m, tri, bary, at);
	// Seen from the front: only emission depends on the side.
	surface s = surface_at(p.id, p.uv, vec3(0.0), -corners_of(tri).normal, 1.0);
	sum.there += weight;
	sum.area += p.weight;
	if (EFFECT_UNLIT && s.unlit)
		return;
	bool polished = EFFECT_GLOSSY && s.roughness * s.roughness <= PATCH_MIRROR_ALPHA;
	sum.emission += weight * s.emission;
	sum.albedo += weight * (polished ? s.albedo : s.base);
	// The metallic share of the base colour: what set_reflectance leaves out of the diffuse part.
	sum.mirror += weight * (polished ? s.base - s.albedo : vec3(0.0));
}

radiosity_surface surface_of(vec3 emission, sums s)
{
	float k = s.there > 0.0 ? 1.0 / s.there : 0.0;
	vec3 e = emission * k, a = min(s.albedo * k, 1.0), m = clamp(s.mirror * k, 0.0, 1.0);
	return radiosity_surface(float[3](e.x, e.y, e.z), float[3](a.x, a.y, a.z), float[3](m.x, m.y, m.z), s.there);
}

void main()
{
	if (gl_GlobalInvocationID.x >= push.count)
		return;
	uint i = push.first + gl_GlobalInvocationID.x;
	radiosity_patch p = radiosity_patches[i];
	uint count = points_of(p);
	sums sum = sums(vec3(0.0), vec3(0.0), vec3(0.0), 0.0, 0.0);
	for (uint k = 0u; k < count; k++)
		look_at(sum, patch_point_at(i, p.face, square_point(k, count)));
	radiosity_surface front = surface_of(sum.emission, sum);
	material m = materials[triangles[p.triangle].material];
	bool both = (m.flags & MATERIAL_EMITS_BOTH_SIDES) != 0u;
	radiosity_surface back = surface_of(both ? sum.emission : vec3(0.0), sum);
	front.there = back.there = min(sum.there / sum.area, 1.0);
	radiosity_surfaces[i] = front;
	radiosity_surfaces[i + PATCH_COUNT] = back;
}
