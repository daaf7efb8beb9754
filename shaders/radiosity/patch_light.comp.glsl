// Irradiance of patches straight from lights: one point, spot or directional light in a dispatch, or the environment's picture
// on one side of them, or the emissive surfaces there. An invocation a patch; what it finds is added to what is there.
//
// The light of an even picture is sampled by the cosine about the normal. That of an uneven one is sampled twice at each point,
// also by the picture's table, as the path tracer does it: the power heuristic weights the two (Veach 1997, 9.2). Rays by the
// cosine also go on at mirrors. Emissive surfaces are sampled in the same two ways, by points on them and by the cosine.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_vote : require
#extension GL_KHR_shader_subgroup_shuffle : require

#include "shared/patch_pass.h"

layout(constant_id = SPEC_PATCH_COUNT) const uint PATCH_COUNT = 0u;
layout(constant_id = SPEC_PATCH_SKY) const uint SKY = PATCH_SKY_NONE;
layout(constant_id = SPEC_PATCH_DISCS) const bool DISCS = false;
layout(constant_id = SPEC_PATCH_LAMPS) const bool LAMPS = false;
layout(constant_id = SPEC_PATCH_BOUNCES) const uint BOUNCES = 0u;
#define DISC_LIGHTS DISCS

#include "common/light.glsl"
#include "trace/traverse.glsl"

layout(local_size_x = PATCH_GROUP) in;

layout(push_constant) uniform Push {
	patch_push push;
};
layout(std430, set = 0, binding = BIND_COUNTERS) buffer Counters {
	pass_counters counters;
};
layout(std430, set = 0, binding = BIND_RADIOSITY_SURFACES) readonly buffer Surfaces {
	radiosity_surface radiosity_surfaces[];
};
layout(std430, set = 0, binding = BIND_PATCH_LIGHT) buffer Light {
	float patch_light[];
};
layout(std430, set = 0, binding = BIND_PATCH_SKY) readonly buffer SkyTexels {
	vec4 sky_texels[];
};
layout(std430, set = 0, binding = BIND_PATCH_SKY_ROWS) readonly buffer SkyRows {
	environment_row sky_rows[];
};
#include "common/sky_sample.glsl"
#include "radiosity/patch_point.glsl"
#include "radiosity/element.glsl"

// A point of a patch that light may reach.
struct receiver {
	vec3 at;       // on the surface
	vec3 normal;   // unit, the front's
	float offset;  // metres along it at which rays start
	float weight;  // area that it stands for, over the patch's, as far as masks leave it there
	float open;    // the same on the front, where no other body covers it
};

// What a ray brings if nothing stops it. t_max is -1 if there is no ray.
struct lit {
	vec3 from;
	vec3 segment;
	float t_max;
	vec3 irradiance; // W/m²
	bool back;
};

bool may_lack(material m)
{
	return (EFFECT_ALPHA_MASK && (m.flags & MATERIAL_ALPHA_MASK) != 0u) ||
	       (EFFECT_ALPHA_BLEND && (m.flags & MATERIAL_ALPHA_BLEND) != 0u);
}

float cover_of(patch_point p)
{
	triangle tri = triangles[p.id];
	vec3 bary = vec3(1.0 - p.uv.x - p.uv.y, p.uv);
	vec4 at = EFFECT_TEXTURES ? coordinates_at(tri, bary) : vec4(0.0);
	return coverage_at(materials[tri.material], tri, bary, at);
}

// The place of a point in the unit square: the same for every light. Scrambled points have smaller errors than Hammersley's where
// light varies smoothly, and those of neighbours know nothing of each other.
vec2 place_of(uint i, uint point)
{
	return sample_2d(sampler_make(i, 0u, point, job.seed[0], job.seed[1]), SET_PIXEL);
}

// The sums of the points' weights on the back and on the front.
vec2 weights_of(uint i, radiosity_patch p)
{
	bool lacks = may_lack(materials[triangles[p.triangle].material]);
	if (!lacks && covers_part(p.covered) == 0u)
		return vec2(float(push.all));
	vec2 sum = vec2(0.0);
	for (uint k = 0u; k < push.all; k++) {
		vec2 place = place_of(i, k);
		patch_point at = patch_point_at(i, p.face, place);
		float weight = at.weight * (lacks ? cover_of(at) : 1.0);
		sum += vec2(weight, cover_has(p.covered, place) ? 0.0 : weight);
	}
	return sum;
}

receiver receiver_at(uint i, radiosity_patch of, uint point, vec2 sum)
{
	vec2 place = place_of(i, point);
	patch_point p = patch_point_at(i, of.face, place);
	triangle tri = triangles[p.id];
	corners k = corners_of(tri);
	receiver r;
	r.at = point_inside(k, p.uv, position_error(k));
	r.normal = k.normal;
	r.offset = start_offset(k, r.at);
	float weight = p.weight * (may_lack(materials[tri.material]) ? cover_of(p) : 1.0);
	r.weight = weight / max(sum.x, 1e-30);
	r.open = cover_has(of.covered, place) ? 0.0 : weight / max(sum.y, 1e-30);
	return r;
}

lit lit_by(uint number, receiver r, vec2 u)
{
	punctual_light light = lights[number];
	lit l;
	vec3 w;
	l.irradiance = punctual_irradiance(light, r.at, w, l.segment, l.t_max);
	if (DISC_LIGHTS && light.spread > 0.0)
		l.segment = w = in_disc(light, w, u, l.irradiance);
	l.back = dot(r.normal, w) < 0.0;
	l.from = r.at + (l.back ? -r.offset : r.offset) * r.normal;
	if (light.kind != LIGHT_DIRECTIONAL)
		l.irradiance = punctual_irradiance(light, l.from, w, l.segment, l.t_max);
	l.irradiance *= abs(dot(r.normal, w)) * (l.back ? r.weight : r.open);
	l.t_max = l.irradiance != vec3(0.0) ? l.t_max : -1.0;
	return l;
}

float cosine_pdf(vec3 n, vec3 w)
{
	return max(dot(n, w), 0.0) * (1.0 / PI);
}

// A direction of the picture's table.
lit lit_by_table(receiver r, vec3 n, uvec2 bits, vec2 u)
{
	lit l;
	uint texel = sky_pick(bits);
	l.segment = sky_direction(texel, u);
	float pdf = sky_texels[texel].w;
	sky_view v = sky_at(l.segment);
	float cosine = cosine_pdf(n, l.segment);
	bool some = pdf > 0.0 && cosine > 0.0;
	float weight = power_weight(min(cosine / max(v.pdf, 1e-30), 1e18));
	l.irradiance = v.radiance * (cosine * PI * weight * r.weight / max(pdf, 1e-37));
	l.back = push.back != 0u;
	l.from = r.at + r.offset * n;
	l.t_max = some ? INFINITY : -1.0;
	return l;
}

// A point on an emissive surface, chosen by power.
lit lit_by_lamp(receiver r, vec3 n, uvec2 bits, vec2 u)
{
	lit l;
	lamp_pick lamp = pick_emitter(bits);
	vec2 uv = place_on(lamp, uvec2(0u), u);
	emitter_view v;
	l.back = push.back != 0u;
	l.from = r.at + r.offset * n;
	bool some = view_emitter(l.from, lamp, uv, v);
	l.segment = v.segment;
	float cosine = cosine_pdf(n, v.segment / max(length(v.segment), 1e-30));
	float weight = power_weight(min(cosine * v.inverse, 1e18));
	l.irradiance = v.radiance * (cosine * PI * v.inverse * weight * r.weight);
	l.t_max = some && l.irradiance != vec3(0.0) ? 1.0 : -1.0;
	return l;
}

// What the surface that a ray hits emits towards it, weighted beside points on emissive surfaces, which find it if the ray
// came straight from a surface of normal n.
vec3 lit_by_hit(ray_hit hit, vec3 n, vec3 direction, bool straight)
{
	triangle tri = triangles[hit.id];
	material m = materials[tri.material];
	corners k = corners_of(tri);
	float away = dot(k.normal, direction);
	if (m.power_density == 0.0 || (away > 0.0 && (m.flags & MATERIAL_EMITS_BOTH_SIDES) == 0u))
		return vec3(0.0);
	vec3 bary = vec3(1.0 - hit.uv.x - hit.uv.y, hit.uv);
	vec3 radiance = emission_at(m, EFFECT_TEXTURES ? coordinates_at(tri, bary) : vec4(0.0));
	float rival = m.power_density * job.emitter_power_inv * hit.t * hit.t /
		      max(abs(away) * cosine_pdf(n, direction), 1e-30);
	return radiance * (straight ? power_weight(min(rival, 1e18)) : 1.0);
}

// A ray that follows a cosine about the normal, and goes on at mirrors: each passes on its reflectance.
struct seeker {
	vec3 origin;
	vec3 direction;
	vec3 share;
	bool alive;
};

// The ray hit a triangle. Whether it goes on.
bool mirrored(inout seeker s, ray_hit hit)
{
	corners k = corners_of(triangles[hit.id]);
	bool front = dot(k.normal, s.direction) < 0.0;
	uint e = element_at(hit.id, hit.uv, front);
	if (e == NONE)
		return false;
	vec3 mirror = to_vec3(radiosity_surfaces[e].mirror);
	vec3 n = front ? k.normal : -k.normal;
	vec3 p = point_met(k, hit.uv, s.origin, s.direction, hit.t);
	s.origin = p + start_offset(k, p) * n;
	s.direction = normalize(s.direction - 2.0 * dot(s.direction, n) * n);
	s.share *= mirror;
	return max(s.share.r, max(s.share.g, s.share.b)) > 0.0;
}

// What of the picture, or of emissive surfaces, is seen along a cosine's direction.
vec3 lit_by_cosine(receiver r, vec3 n, vec2 u, bool lamps, bool mine)
{
	vec3 x, y;
	frame_make(n, x, y);
	vec3 local = cosine_hemisphere(u);
	seeker s = seeker(r.at + r.offset * n, local.x * x + local.y * y + local.z * n, vec3(r.weight * PI), mine);
	vec3 found = vec3(0.0);
	uint bounce = 0u;
	bool more = true;
	do {
		ray_hit hit;
		bool met = BOUNCES > 0u || LAMPS ? trace_closest(s.origin, s.direction, s.alive ? INFINITY : -1.0, hit)
					: trace_any(s.origin, s.direction, s.alive ? INFINITY : -1.0);
		if (LAMPS && lamps && s.alive && met)
			found += lit_by_hit(hit, n, s.direction, bounce == 0u) * s.share;
		if (SKY != PATCH_SKY_NONE && !lamps && s.alive && !met) {
			sky_view v = sky_at(s.direction);
			// The table finds only what is seen directly.
			float rival = SKY == PATCH_SKY_BOTH ? v.pdf / max(cosine_pdf(n, s.direction), 1e-30) : 0.0;
			float weight = bounce > 0u ? 1.0 : power_weight(min(rival, 1e18));
			found = v.radiance * s.share * weight;
		}
		s.alive = s.alive && met && bounce < BOUNCES;
		if (BOUNCES > 0u) {
			if (s.alive)
				s.alive = mirrored(s, hit);
			more = subgroupAny(s.alive);
		}
		bounce++;
	} while (BOUNCES > 0u && more && bounce <= BOUNCES);
	return found;
}

void add(uint element, vec3 irradiance)
{
	for (uint c = 0u; c < 3u; c++)
		patch_light[3u * element + c] += irradiance[c];
}

void main()
{
	bool mine = gl_GlobalInvocationID.x < push.count;
	uint i = push.first + (mine ? gl_GlobalInvocationID.x : 0u);
	radiosity_patch p = radiosity_patches[i];
	vec2 sum = weights_of(i, p);
	bool lamps = LAMPS && push.light == PATCH_LAMPS;
	bool sky = SKY != PATCH_SKY_NONE && push.light == NONE;
	vec3 front = vec3(0.0), back = vec3(0.0);
	for (uint k = 0u; k < push.points; k++) {
		uint point = push.point + k;
		sampler_state rnd = sampler_make(i, 1u + push.back, point, job.seed[0], job.seed[1] ^ push.light);
		receiver r = receiver_at(i, p, point, sum);
		if (push.back == 0u && (sky || lamps))
			r.weight = r.open;
		if (EFFECT_ALPHA_BLEND) {
			trace_chance = hash_combine(rnd.scramble, SET_ALPHA);
			trace_index = point;
		}
		vec3 n = push.back != 0u ? -r.normal : r.normal;
		lit l;
		l.t_max = -1.0;
		l.from = r.at;
		l.segment = r.normal;
		l.irradiance = vec3(0.0);
		l.back = push.back != 0u;
		if (sky || lamps) {
			vec3 seen = lit_by_cosine(r, n, sample_2d(rnd, SET_BSDF), lamps, mine);
			front += push.back == 0u ? seen : vec3(0.0);
			back += push.back != 0u ? seen : vec3(0.0);
			if (LAMPS && lamps)
				l = lit_by_lamp(r, n, sample_bits(rnd, SET_PICK), sample_2d(rnd, SET_LIGHT));
			else if (SKY == PATCH_SKY_BOTH)
				l = lit_by_table(r, n, sample_bits(rnd, SET_PICK), sample_2d(rnd, SET_LIGHT));
		} else if (EFFECT_LIGHTS && push.light != NONE)
			l = lit_by(push.light, r, sample_2d(rnd, SET_LIGHT));
		if (EFFECT_ALPHA_BLEND)
			trace_chance = ~trace_chance;
		bool shadowed = trace_any(l.from, l.segment, mine ? l.t_max : -1.0);
		vec3 seen = shadowed || l.t_max < 0.0 ? vec3(0.0) : l.irradiance;
		front += l.back ? vec3(0.0) : seen;
		back += l.back ? seen : vec3(0.0);
	}
	if (!mine)
		return;
	if (front != vec3(0.0))
		add(i, front);
	if (back != vec3(0.0))
		add(i + PATCH_COUNT, back);
	if (trace_cut)
		atomicAdd(counters.cut, 1u);
	atomicMax(counters.loop_rounds, trace_rounds);
}
