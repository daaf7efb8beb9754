// The final gather (Reichert 1992; Lischinski, Tampieri and Greenberg 1993, "Combining hierarchical radiosity and
// discontinuity meshing", sec. 5): rays from each pixel's place, by the cosine, look up what the surfaces that they meet
// reflect. So the mesh shows only in the light of the second place, and the pixel's own shadows are sharp. Light straight
// from lamps and lights is left to another pass, and so is emission: only what is reflected counts, but behind a mirror, where
// that other pass does not look, emission counts, too. Rays that meet nothing see the background.
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

layout(local_size_x = TILE_PIXELS) in;
layout(location = RADIOSITY_RAYS) uniform uvec3 rays;

// A ray on its way.
struct gathered {
	vec3 origin;
	vec3 direction;
	vec3 through;     // share of what it sees that counts; zero: it has ended
	bool plain;       // it sees what shines
};

// Follows a ray to what it meets, and by mirrors from there on.
vec3 follow(gathered g)
{
	vec3 radiance = vec3(0.0);
#if RADIOSITY_BOUNCES > 0
	for (int bounce = 0; bounce <= RADIOSITY_BOUNCES; bounce++) {
#endif
		bool on = max(g.through, vec3(0.0)) != vec3(0.0);
		ray_hit hit;
		bool met = walk_single(g.origin, g.direction, on ? INFINITY : -1.0, false, hit);
		if (on && !met)
			radiance += g.through * background_seen(g.direction);
		if (!met)
			return radiance;
		float share;
		place p = place_fetch(hit.id);
		place_met(p, hit.uv, g.direction);
		radiance += g.through * place_seen(p, g.plain, share);
#if RADIOSITY_BOUNCES > 0
		surface s = surface_at(hit.id, hit.uv, g.origin, g.direction, hit.t);
		g.through *= mirror_reflectance(s, share, g.direction);
		g.origin = s.position + s.offset * s.geometric;
		g.direction = mirrored(s, g.direction);
		g.plain = true;
	}
#endif
	return radiance;
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
	vec3 x, y;
	frame_make(s.shading, x, y);
	sampler_state random = sampler_make(pixel.y * turn.w + pixel.x, turn.x, 0u, job.seed[0], job.seed[1]);
	vec3 radiance = vec3(0.0);
	uint traced = 0u;
	// One ray more, in the first pass, goes on in the direction of a mirror.
	uint begin = RADIOSITY_BOUNCES > 0 && rays.x == 0u ? 0u : 1u;
	for (uint i = begin; i <= rays.y - rays.x; i++) {
		gathered g;
		g.origin = s.position + s.offset * s.geometric;
		g.plain = i == 0u;
		if (g.plain) {
			g.direction = mirrored(s, v.direction);
			g.through = mirror_reflectance(s, share, v.direction);
		} else {
			random.index = turn.y * rays.z + rays.x + i - 1u;
			vec3 l = cosine_hemisphere(sample_2d(random, SET_BSDF));
			vec3 w = l.x * x + l.y * y + l.z * s.shading;
			float above = dot(w, s.geometric);
			g.direction = above < 0.0 ? w - 2.0 * above * s.geometric : w;
			g.through = diffuse;
		}
		traced += max(g.through, vec3(0.0)) != vec3(0.0) ? 1u : 0u;
		radiance += follow(g);
	}
	pixel_add_traced(pixel, radiance, traced, trace_cut);
}
