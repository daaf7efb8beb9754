// Follows by rays what mirrors reflect of the pixels of hemicubes: a lane has one of the pixels that hemicube_sum.comp.glsl has
// found at mirrors. Its ray starts where the pixel's own ray meets the mirror and goes on in the mirror's direction, with what
// is left of the pixel's share as its weight, from mirror to mirror.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#define SCENE_WITHOUT_LAMPS
#define SCENE_WITHOUT_TANGENTS
#define SCENE_WITHOUT_GGX
#define HEMICUBE_MIRRORS
#include "radiosity/hemicube_count.glsl"
#include "radiosity/mirror_ray.glsl"
#include "trace/single.glsl"

layout(local_size_x = HEMICUBE_LANES) in;

layout(location = HEMICUBE_BOUNCES) uniform uvec2 bounces;
layout(std430, binding = BIND_HEMICUBE_PIXELS) buffer Pixels {
	hemicube_pixels pixels_head;
	uvec2 pixels[];
};

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= pixels_head.count)
		return;
	uint n = sizes.x;
	uint weight = pixels[i].y;
	uint pixel = pixels[i].x % (3u * n * n);
	uint cell = pixels[i].x / (3u * n * n);
	uvec3 place = hemicube_place(pixel);
	uvec2 at;
	uint entry;
	uint face = hemicube_face(place, at);
	hemicube_cell c = hemicube_cells[cell];
	vec3 origin = hemicube_vec3(c.eye);
	vec3 direction = normalize(into_world(c, pixel_direction(face, at, entry)));
	uint id = texelFetch(ids, hemicube_texel(cell, place), 0).x - 1u;
	place_seen p = place_of(id, origin, direction);
	mirror_reflect(corners_of(triangles[id]), p.uv, p.t, origin, direction);
	uint bounce = 1u;
	while (weight > 0u) {
		ray_hit hit;
		bool found = walk_single(origin, direction, INFINITY, false, hit);
		corners met = corners_of(triangles[found ? hit.id : 0u]);
		uint word = found ? texelFetch(hemicube_corners, int(3u * hit.id)).w : NONE;
		uint element = element_of(word, hit.uv, dot(met.normal, direction) < 0.0);
		uint left = 0u;
		if (!found)
			count_escaped(c.row, weight);
		else if (element == NONE)
			count_cut(c.row, weight);
		else {
			count_for(c.row, element, weight);
			left = mirrors[element].plane == 0u ? 0u : mirrored(element, weight);
		}
		if (left > 0u && bounce == bounces.y) {
			count_cut(c.row, left);
			left = 0u;
		}
		weight = left;
		mirror_reflect(met, hit.uv, hit.t, origin, direction);
		bounce++;
		trace_rounds++;
	}
	if (trace_cut || weight > 0u)
		pixels_head.cut = 1u;
}
