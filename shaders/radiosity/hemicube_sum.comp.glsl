// Sums up what the pixels of hemicubes see, by element: a lane looks at pixels side by side. An element that a row meets for the first time
// is added to the row's list.
//
// At a mirror the weight is counted for the mirror's own element, and what it reflects goes on: by another cell, which is drawn
// as the mirror shows it (HEMICUBE_PORTAL), or by a ray of hemicube_rays.comp.glsl (HEMICUBE_HYBRID). The pixel's own share is
// the weight of all of it.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#if defined(HEMICUBE_PORTAL) || defined(HEMICUBE_HYBRID)
#define HEMICUBE_MIRRORS
#endif
#include "radiosity/hemicube_count.glsl"

layout(local_size_x = HEMICUBE_LANES) in;

layout(binding = UNIT_HEMICUBE_TABLE) uniform usamplerBuffer shares;
#ifdef HEMICUBE_MIRRORS
layout(location = HEMICUBE_BOUNCES) uniform uvec2 bounces;
#endif
#ifdef HEMICUBE_PORTAL
layout(std430, binding = BIND_HEMICUBE_SEEN) buffer Seen {
	uint planes_seen[];
};
layout(location = HEMICUBE_PLANES) uniform uint plane_words;
layout(binding = UNIT_HEMICUBE_PARENTS) uniform usampler2DArray parents;
layout(rg32ui, binding = IMAGE_HEMICUBE_FOUND) writeonly uniform uimage2DArray found;
#endif
#ifdef HEMICUBE_HYBRID
layout(std430, binding = BIND_HEMICUBE_PIXELS) buffer Pixels {
	hemicube_pixels pixels_head;
	uvec2 pixels[];
};
#endif

// What a lane has counted for one element, or for none (NONE), and not yet added to the row's sum.
uint run_element = NONE;
uint run_weight = 0u;

void end_run(uint row)
{
	if (run_weight > 0u && run_element == NONE)
		count_escaped(row, run_weight);
	else if (run_weight > 0u)
		count_for(row, run_element, run_weight);
}

void count_run(uint row, uint element, uint weight)
{
	bool same = element == run_element && run_weight + weight >= weight;
	if (!same)
		end_run(row);
	run_weight = same ? run_weight + weight : weight;
	run_element = element;
}

void sum_pixel(hemicube_cell c, uint cell, uint pixel)
{
	uvec3 place = hemicube_place(pixel);
	uvec2 at;
	uint face = hemicube_face(place, at);
	ivec3 texel = hemicube_texel(cell, place);
	uint entry;
	vec3 local = pixel_direction(face, at, entry);
	uint weight = texelFetch(shares, int(entry)).x;
#ifdef HEMICUBE_PORTAL
	if (c.plane != 0u) {
		uvec2 parent = texelFetch(parents, hemicube_texel(c.parent, place), 0).xy;
		weight = parent.x == c.plane ? parent.y : 0u;
	}
	uvec2 goes_on = uvec2(0u);
#endif
	uint id = texelFetch(ids, texel, 0).x;
	if (weight > 0u && id == 0u)
		count_run(c.row, NONE, weight);
	if (weight > 0u && id != 0u) {
		place_seen p = place_of(id - 1u, hemicube_vec3(c.eye), into_world(c, local));
		uint element = element_of(p.word, p.uv, p.front);
		if (element == NONE)
			count_cut(c.row, weight);
		else
			count_run(c.row, element, weight);
#ifdef HEMICUBE_MIRRORS
		uint plane = element == NONE ? 0u : mirrors[element].plane;
		uint left = plane == 0u ? 0u : mirrored(element, weight);
		if (left > 0u && bounces.x == bounces.y)
			count_cut(c.row, left);
		else if (left > 0u) {
#ifdef HEMICUBE_PORTAL
			uint bit = (plane - 1u) * 8u + face;
			goes_on = uvec2(plane, left);
			atomicOr(planes_seen[cell * plane_words + (bit >> 5)], 1u << (bit & 31u));
#else
			uint slot = atomicAdd(pixels_head.count, 1u);
			if (slot % HEMICUBE_LANES == 0u)
				atomicAdd(pixels_head.groups[0], 1u);
			pixels[slot] = uvec2(cell * 3u * sizes.x * sizes.x + pixel, left);
#endif
		}
#endif
	}
#ifdef HEMICUBE_PORTAL
	if (bounces.x < bounces.y)
		imageStore(found, texel, uvec4(goes_on, 0u, 0u));
#endif
}

void main()
{
	uint cell = gl_WorkGroupID.y;
	uint first = gl_GlobalInvocationID.x * HEMICUBE_RUN;
	uint end = min(first + HEMICUBE_RUN, 3u * sizes.x * sizes.x);
	hemicube_cell c = hemicube_cells[cell];
	for (uint pixel = first; pixel < end; pixel++)
		sum_pixel(c, cell, pixel);
	end_run(c.row);
}
