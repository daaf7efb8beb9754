// The final gather (Reichert 1992; Lischinski, Tampieri and Greenberg 1993, "Combining hierarchical radiosity and
// discontinuity meshing", sec. 5): rays from each pixel's place, by the cosine, look up what the surfaces that they meet
// reflect. So the mesh shows only in the light of the second place, and the pixel's own shadows are sharp. Light straight
// from lights is left to another pass, and so is most of lamps': of a lamp that a ray meets counts what RADIOSITY_RIVALS points
// on lamps leave to it by the power heuristic (Veach 1997, 9.2.4), which is most of a near one. Behind a mirror, where that
// other pass does not look, all of it counts. Rays that meet nothing see the background. Of an environment's picture, half as
// many rays again go where its table sends them, and both kinds are weighted by the balance heuristic (9.2.2): with n rays by
// the density p and m by q, each that escapes counts f L / (n p + m q).
//
// What the camera sees in a mirror has no gather of its own: it is looked up.
#version 450 core
#extension GL_GOOGLE_include_directive : require
#define SCENE_WITHOUT_LAMPS

#include "radiosity/texels.glsl"
#include "common/sampling.glsl"
#include "deferred/pixel.glsl"
#include "radiosity/seen.glsl"
#include "trace/single.glsl"

#ifdef RADIOSITY_SKY
layout(binding = RADIOSITY_SKY_UNIT) uniform usamplerBuffer sky_words;
#define SKY_TEXEL(x, y) texelFetch(sky_picture, ivec2(x, y), 0)
#define SKY_ROW(i) environment_row(uintBitsToFloat(texelFetch(sky_words, 2 * int(i)).x), texelFetch(sky_words, 2 * int(i) + 1).x)
#include "common/sky_sample.glsl"
#define GATHER_SKY true
#else
#define GATHER_SKY false
#endif

// Whether light scatters once, so that there is nothing to gather but background; a macro that the program defines.
#ifndef RADIOSITY_ONCE
#define RADIOSITY_ONCE false
#endif

// Points on lamps in a pixel's sample, chosen by power, beside which rays find lamps; 0.0: rays find none, and points all. A
// macro that the program defines.
#ifndef RADIOSITY_RIVALS
#define RADIOSITY_RIVALS 0.0
#endif

layout(local_size_x = TILE_PIXELS) in;
layout(location = RADIOSITY_RAYS) uniform uvec3 rays;

// A ray on its way.
struct gathered {
	vec3 origin;
	vec3 direction;
	vec3 through;     // share of what it sees that counts; zero: it has ended
	bool plain;       // it sees what shines
	bool sky;         // it sees the environment alone
	float density;    // by the cosine, 1/sr, times the number of rays of that kind
};

// Of the rays before ray i by the cosine, or among so many: those that go to the environment.
uint to_sky(uint i)
{
	return (i + 1u) / 2u;
}

// What a ray sees that meets nothing. Weighted, unless a mirror has sent it.
vec3 sky_gathered(gathered g, bool first)
{
#ifdef RADIOSITY_SKY
	sky_view v = sky_at(g.direction);
	bool weighted = first && !g.plain;
	return v.radiance * (weighted ? g.density / max(g.density + float(to_sky(rays.z)) * v.pdf, 1e-30) : 1.0);
#else
	return background_seen(g.direction);
#endif
}

// What counts of the light of a lamp that a ray has met.
float lamp_weight(gathered g, place p, float t, float power)
{
	if (g.plain)
		return 1.0;
	float rival = RADIOSITY_RIVALS * power * job.emitter_power_inv * t * t / max(abs(p.away), 1e-7);
	return RADIOSITY_RIVALS > 0.0 && power > 0.0 ? power_weight(min(rival / max(g.density, 1e-30), 1e18)) : 0.0;
}

// Follows a ray to what it meets, and by mirrors from there on.
vec3 follow(gathered g)
{
	vec3 radiance = vec3(0.0);
	bool first = true;
#if RADIOSITY_BOUNCES > 0
	for (int bounce = 0; bounce <= RADIOSITY_BOUNCES; bounce++) {
#endif
		bool on = max(g.through, vec3(0.0)) != vec3(0.0);
		ray_hit hit;
		bool met = walk_single(g.origin, g.direction, on ? INFINITY : -1.0, false, hit);
		if (on && !met)
			radiance += g.through * sky_gathered(g, first);
		if (!met || g.sky)
			return radiance;
		place p = place_fetch(hit.id);
		place_met(p, hit.uv, g.direction);
		seen at = place_seen(p);
		if (!RADIOSITY_ONCE || g.plain)
			radiance += g.through * at.reflected;
		radiance += g.through * at.shining * lamp_weight(g, p, hit.t, at.power);
#if RADIOSITY_BOUNCES > 0
		surface s = surface_at(hit.id, hit.uv, g.origin, g.direction, hit.t);
		g.through *= mirror_reflectance(s, at.share, g.direction);
		g.origin = s.position + s.offset * s.geometric;
		g.direction = mirrored(s, g.direction);
		g.plain = true;
		first = false;
	}
#endif
	return radiance;
}

vec3 folded_up(surface s, vec3 w)
{
	float above = dot(w, s.geometric);
	return above < 0.0 ? w - 2.0 * above * s.geometric : w;
}

#ifdef RADIOSITY_SKY
// Sends a ray to the environment.
void aim_at_sky(surface s, sampler_state random, inout gathered g)
{
	vec3 w = sky_direction(sky_pick(sample_bits(random, SET_PICK)), sample_2d(random, SET_LIGHT));
	g.sky = true;
	g.through = dot(w, s.geometric) > 0.0 ? g.through : vec3(0.0);
	g.direction = w;
}
#endif

// The density of a direction by the cosine, and of the one that is folded to it, 1/sr.
float cosine_density(surface s, vec3 normal, vec3 w)
{
	vec3 below = w - 2.0 * dot(w, s.geometric) * s.geometric;
	return (max(dot(w, normal), 0.0) + max(dot(below, normal), 0.0)) * (1.0 / PI);
}

void main()
{
	uvec2 pixel;
	visible_point v;
	if (!pixel_mine(pixel) || !pixel_visible(pixel, v))
		return;
	surface s = pixel_surface(v);
	if (EFFECT_UNLIT && s.unlit)
		return;
	float share = mirror_share_at(v.id, v.uv);
	vec3 diffuse = s.base * ((1.0 - share) / float(rays.z));
	// The one by which the points on lamps weigh these rays (bsdf_make).
	vec3 normal = normal_in_front(s.shading, -v.direction);
	vec3 x, y;
	frame_make(normal, x, y);
	sampler_state random = sampler_make(pixel.y * turn.w + pixel.x, turn.x, 0u, job.seed[0], job.seed[1]);
	vec3 radiance = vec3(0.0);
	uint traced = 0u;
	uint count = rays.y - rays.x;
	uint skies = GATHER_SKY ? to_sky(rays.y) - to_sky(rays.x) : 0u;
	// One ray more, in the first pass, goes on in the direction of a mirror.
	for (uint i = RADIOSITY_BOUNCES > 0 && rays.x == 0u ? 0u : 1u; i <= count + skies; i++) {
		gathered g;
		g.origin = s.position + s.offset * s.geometric;
		g.plain = i == 0u;
		g.sky = false;
		g.through = diffuse;
		random.index = turn.y * rays.z + rays.x + i - 1u;
		vec3 l = cosine_hemisphere(sample_2d(random, SET_BSDF));
		g.direction = folded_up(s, l.x * x + l.y * y + l.z * normal);
#ifdef RADIOSITY_SKY
		random.index = turn.y * to_sky(rays.z) + to_sky(rays.x) + i - 1u - count;
		if (i > count)
			aim_at_sky(s, random, g);
#endif
		g.density = float(rays.z) * cosine_density(s, normal, g.direction);
		if (g.plain) {
			g.direction = mirrored(s, v.direction);
			g.through = mirror_reflectance(s, share, v.direction);
		}
		traced += max(g.through, vec3(0.0)) != vec3(0.0) ? 1u : 0u;
		radiance += follow(g);
	}
	pixel_add_traced(pixel, radiance, traced, trace_cut);
}
