// Sums up what the pixels of hemicubes see, by element: a lane looks at a pixel. The sums are of integers, so their order
// does not matter. An element that a row meets for the first time is added to the row's list.
//
// At a mirror the weight is counted for the mirror's own element, and what it reflects goes on: by another cell that is drawn
// as the mirror shows it (HEMICUBE_PORTAL), or by a ray (HEMICUBE_HYBRID). The pixel's own share is the weight of all of it.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "radiosity/hemicube.glsl"

#ifdef HEMICUBE_HYBRID
#define SCENE_WITHOUT_LAMPS
#define SCENE_WITHOUT_TANGENTS
#define SCENE_WITHOUT_GGX
#include "common/surface.glsl"
#include "trace/single.glsl"
#endif

layout(local_size_x = HEMICUBE_LANES) in;

layout(binding = UNIT_HEMICUBE_IDS) uniform usampler2DArray ids;
layout(binding = UNIT_HEMICUBE_TABLE) uniform usamplerBuffer shares;
layout(binding = UNIT_HEMICUBE_TRIANGLES) uniform usamplerBuffer hemicube_corners;
layout(std430, binding = BIND_RADIOSITY_FACES) readonly buffer Faces {
	radiosity_face radiosity_faces[];
};
layout(std430, binding = BIND_HEMICUBE_DENSE) buffer Dense {
	uint dense[];
};
layout(std430, binding = BIND_HEMICUBE_ROWS) buffer Rows {
	hemicube_row rows[];
};
layout(std430, binding = BIND_HEMICUBE_LISTS) buffer Lists {
	uint lists[];
};
#if defined(HEMICUBE_PORTAL) || defined(HEMICUBE_HYBRID)
layout(std430, binding = BIND_HEMICUBE_MIRRORS) readonly buffer Mirrors {
	hemicube_mirror mirrors[];
};
#endif
#ifdef HEMICUBE_PORTAL
layout(std430, binding = BIND_HEMICUBE_SEEN) buffer Seen {
	uint planes_seen[];
};
layout(location = HEMICUBE_PLANES) uniform uint plane_words;
layout(binding = UNIT_HEMICUBE_PARENTS) uniform usampler2DArray parents;
layout(rg32ui, binding = IMAGE_HEMICUBE_FOUND) writeonly uniform uimage2DArray found;
#endif

#define RADIOSITY_PLACES_ONLY
#include "radiosity/element.glsl"

// The direction of a pixel's middle in the cell's frame, and its place in the table.
vec3 pixel_direction(uint face, uvec2 at, out uint entry)
{
	uint half_n = sizes.x / 2u;
	float side = 2.0 / float(sizes.x);
	vec2 p = (vec2(at) + 0.5) * side;
	uint x = at.x < half_n ? half_n - 1u - at.x : at.x - half_n;
	uint y = face != 0u ? half_n + at.y : at.y < half_n ? half_n - 1u - at.y : at.y - half_n;
	entry = y * half_n + x;
	float u = p.x - 1.0;
	float away = face == 1u || face == 3u ? 1.0 : -1.0;
	return face == 0u ? vec3(u, p.y - 1.0, 1.0) : face <= 2u ? vec3(away, u, p.y) : vec3(u, away, p.y);
}

// Where a ray in direction d meets triangle `id`, whose corners are a, b and c from where it starts: barycentrics of corners
// 1 and 2, by its plane. The rasteriser rounds corners to a part of a pixel, so the place may be off the triangle by as much.
// A pixel that sees the triangle edge-on gets its middle.
vec2 place_met(vec3 a, vec3 e1, vec3 e2, vec3 n, vec3 d)
{
	vec3 p = d * (dot(n, a) / dot(n, d)) - a;
	float n2 = dot(n, n);
	vec2 uv = vec2(dot(cross(p, e2), n), dot(cross(e1, p), n)) / n2;
	vec3 b = vec3(1.0 - uv.x - uv.y, uv);
	// Written as comparisons that a NaN fails.
	b = vec3(b.x > 0.0 ? min(b.x, 1.0) : 0.0, b.y > 0.0 ? min(b.y, 1.0) : 0.0, b.z > 0.0 ? min(b.z, 1.0) : 0.0);
	float sum = b.x + b.y + b.z;
	return sum > 0.0 ? b.yz / sum : vec2(1.0 / 3.0);
}

uint element_of(uint word, vec2 uv, bool front)
{
	if (word == NONE)
		return NONE;
	radiosity_face f = radiosity_faces[word >> RADIOSITY_FACE_SHIFT];
	vec2 inside;
	uint i = patch_at(f, face_place(word, f, uv), inside);
	return front ? i : i + sizes.z / 2u;
}

// The element that triangle `id` shows in direction d from `eye`.
uint element_seen(uint id, vec3 eye, vec3 d)
{
	uvec4 first = texelFetch(hemicube_corners, int(3u * id));
	vec3 a = uintBitsToFloat(first.xyz) - eye;
	vec3 b = uintBitsToFloat(texelFetch(hemicube_corners, int(3u * id + 1u)).xyz) - eye;
	vec3 c = uintBitsToFloat(texelFetch(hemicube_corners, int(3u * id + 2u)).xyz) - eye;
	vec3 m = max(abs(b - a), abs(c - a));
	float k = 1.0 / max(max(m.x, max(m.y, m.z)), 1e-30);
	vec3 e1 = (b - a) * k;
	vec3 e2 = (c - a) * k;
	vec3 n = cross(e1, e2);
	return element_of(first.w, place_met(a * k, e1, e2, n, d), dot(n, d) < 0.0);
}

void count_for(uint row, uint element, uint weight)
{
	if (atomicAdd(dense[row * sizes.z + element], weight) == 0u)
		lists[row * sizes.w + atomicAdd(rows[row].count, 1u)] = element;
}

uint mirrored(uint weight, float share)
{
	return uint(float(weight) * share);
}

void main()
{
	uint n = sizes.x;
	uint pixel = gl_GlobalInvocationID.x;
	uint cell = range.x + gl_WorkGroupID.y;
	uvec2 at = uvec2(pixel % (2u * n), pixel / (2u * n));
	uvec2 corner;
	uint face = hemicube_face(at, corner);
	hemicube_cell c = hemicube_cells[cell];
	ivec3 texel = hemicube_texel(cell, at);
	if (at.y >= n + n / 2u)
		return;
	uint entry;
	vec3 local = pixel_direction(face, at - corner, entry);
	uint weight = texelFetch(shares, int(entry)).x;
#ifdef HEMICUBE_PORTAL
	if (c.plane != 0u) {
		uvec2 parent = texelFetch(parents, hemicube_texel(c.parent, at), 0).xy;
		weight = parent.x == c.plane ? parent.y : 0u;
	}
	uvec2 goes_on = uvec2(0u);
#endif
	uint id = texelFetch(ids, texel, 0).x;
	if (weight > 0u && id == 0u)
		atomicAdd(rows[c.row].escaped, weight);
	if (weight > 0u && id != 0u) {
		vec3 d = local.x * hemicube_vec3(c.x) + local.y * hemicube_vec3(c.y) + local.z * hemicube_vec3(c.z);
		uint element = element_seen(id - 1u, hemicube_vec3(c.eye), d);
		if (element == NONE)
			atomicAdd(rows[c.row].cut, weight);
		else
			count_for(c.row, element, weight);
#ifdef HEMICUBE_PORTAL
		if (element != NONE && mirrors[element].plane != 0u) {
			uint left = mirrored(weight, mirrors[element].share);
			if (range.z == range.w && left > 0u)
				atomicAdd(rows[c.row].cut, left);
			else if (left > 0u) {
				uint plane = mirrors[element].plane;
				goes_on = uvec2(plane, left);
				atomicOr(planes_seen[gl_WorkGroupID.y * plane_words + (plane >> 5)], 1u << (plane & 31u));
			}
		}
#endif
	}
#ifdef HEMICUBE_PORTAL
	if (range.z < range.w)
		imageStore(found, texel, uvec4(goes_on, 0u, 0u));
#endif
}
