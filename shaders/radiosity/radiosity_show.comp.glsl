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

#include "deferred/pixel.glsl"
#include "radiosity/seen.glsl"
#if RADIOSITY_BOUNCES > 0
#include "trace/single.glsl"
#endif

layout(local_size_x = TILE_PIXELS) in;

void show_light(uvec2 pixel, visible_point v)
{
	vec3 radiance = vec3(0.0);
	vec3 through = vec3(1.0);
	uint rays = 0u;
	bool cut = false;
#if RADIOSITY_BOUNCES > 0
	for (int bounce = 0; bounce <= RADIOSITY_BOUNCES; bounce++) {
#endif
		surface s = surface_at(v.id, v.uv, v.origin, v.direction, v.t);
		float share = mirror_share(s, triangles[v.id], v.uv);
		radiance += through * surface_seen(s, v.id, v.uv, share, true);
#if RADIOSITY_BOUNCES > 0
		through *= mirror_reflectance(s, share, v.direction);
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
	}
	cut = trace_cut;
#endif
	pixel_add_traced(pixel, radiance, rays, cut);
}

void main()
{
	uvec2 pixel;
	visible_point v;
	if (!pixel_mine(pixel))
		return;
	if (!pixel_visible(pixel, v)) {
		if (!RADIOSITY_PLAIN)
			pixel_add(pixel, background_seen(v.direction));
		return;
	}
	if (RADIOSITY_PLAIN)
		pixel_add(pixel, value_at(v.id, v.uv, dot(corners_of(triangles[v.id]).normal, v.direction) < 0.0));
	else
		show_light(pixel, v);
}
