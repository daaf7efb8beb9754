// Radiosity as the camera sees it: the light of elements times the colour of each place, with textures; or, with
// RADIOSITY_PLAIN, a value of each element as it is.
#version 450 core
#extension GL_GOOGLE_include_directive : require
#define SCENE_WITHOUT_LAMPS
#define SCENE_WITHOUT_TANGENTS

#ifndef RADIOSITY_PLAIN
#define RADIOSITY_PLAIN false
#define RADIOSITY_BOUNCES 2
#endif
#if RADIOSITY_BOUNCES == 0
#define SCENE_WITHOUT_TRACE
#endif

#include "radiosity/texels.glsl"
#include "deferred/pixel.glsl"
#include "radiosity/seen.glsl"
#if RADIOSITY_BOUNCES > 0
#include "trace/single.glsl"
#endif

layout(local_size_x = TILE_PIXELS) in;

void show_light(uvec2 pixel, visible_point v, place p)
{
	vec3 radiance = vec3(0.0);
	vec3 through = vec3(1.0);
	uint rays = 0u;
	bool cut = false;
#if RADIOSITY_BOUNCES > 0
	for (int bounce = 0; bounce <= RADIOSITY_BOUNCES; bounce++) {
#endif
		seen at = place_seen(p);
		radiance += through * (at.reflected + at.shining);
#if RADIOSITY_BOUNCES > 0
		surface s = surface_at(v.id, v.uv, v.origin, v.direction, v.t);
		through *= mirror_reflectance(s, at.share, v.direction);
		bool on = bounce < RADIOSITY_BOUNCES && max(through, vec3(0.0)) != vec3(0.0);
		v.origin = s.position + s.offset * s.geometric;
		v.direction = mirrored(s, v.direction);
		ray_hit hit;
		bool met = walk_single(v.origin, v.direction, on ? INFINITY : -1.0, false, hit);
		rays += on ? 1u : 0u;
		if (!met) {
			radiance += on ? through * background_seen(v.direction) : vec3(0.0);
			break;
		}
		v.id = hit.id;
		v.uv = hit.uv;
		v.t = hit.t;
		p = place_fetch(hit.id);
		place_met(p, hit.uv, v.direction);
	}
	cut = trace_cut;
#endif
	pixel_add_traced(pixel, radiance, rays, cut);
}

void main()
{
	uvec2 pixel;
	if (!pixel_mine(pixel))
		return;
	visible_point v = visible_ray(pixel);
	uint id = texelFetch(visibility, pixel_texel(pixel), 0).x;
	if (id == 0u) {
		if (!RADIOSITY_PLAIN)
			pixel_add(pixel, background_seen(v.direction));
		return;
	}
	// What the rasteriser has found is before the eye.
	place p = place_fetch(id - 1u);
	visible_on(v, id - 1u, p.v0, p.v1, p.v2);
	place_met(p, v.uv, v.direction);
	if (RADIOSITY_PLAIN)
		pixel_add(pixel, value_at(p.id, p.uv, p.front));
	else
		show_light(pixel, v, p);
}
