// What passes over the pixels of hemicubes share: counting for elements, by rows, and what mirrors leave of a weight. Sums have
// two words, for a row's sum of small weights is large; they are of integers, so their order does not matter.
#ifndef RADIOSITY_HEMICUBE_COUNT_GLSL
#define RADIOSITY_HEMICUBE_COUNT_GLSL

#include "radiosity/hemicube.glsl"

layout(binding = UNIT_HEMICUBE_IDS) uniform usampler2DArray ids;
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
#ifdef HEMICUBE_MIRRORS
layout(std430, binding = BIND_HEMICUBE_MIRRORS) readonly buffer Mirrors {
	hemicube_mirror mirrors[];
};
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

vec3 into_world(hemicube_cell c, vec3 d)
{
	return d.x * hemicube_vec3(c.x) + d.y * hemicube_vec3(c.y) + d.z * hemicube_vec3(c.z);
}

// A place on a triangle.
struct place_seen {
	uint word;      // of the triangle: RADIOSITY_FACE_…
	vec2 uv;        // barycentrics of corners 1 and 2
	float t;        // on the way there, in units of the direction
	bool front;     // the eye is on its front's side
};

// Where a ray from `eye` in direction d meets the plane of triangle `id`. The rasteriser rounds corners to a part of a pixel,
// so the place may be off the triangle by as much: then the nearest barycentrics are used. A pixel that sees the triangle
// edge-on gets its middle.
place_seen place_of(uint id, vec3 eye, vec3 d)
{
	uvec4 first = texelFetch(hemicube_corners, int(3u * id));
	vec3 a = uintBitsToFloat(first.xyz) - eye;
	vec3 e1 = uintBitsToFloat(texelFetch(hemicube_corners, int(3u * id + 1u)).xyz) - eye - a;
	vec3 e2 = uintBitsToFloat(texelFetch(hemicube_corners, int(3u * id + 2u)).xyz) - eye - a;
	vec3 m = max(abs(e1), abs(e2));
	float k = 1.0 / max(max(m.x, max(m.y, m.z)), 1e-30);
	a *= k;
	e1 *= k;
	e2 *= k;
	vec3 n = cross(e1, e2);
	float along = dot(n, d);
	float t = dot(n, a) / along;
	vec3 p = d * t - a;
	vec2 uv = vec2(dot(cross(p, e2), n), dot(cross(e1, p), n)) / dot(n, n);
	vec3 b = vec3(1.0 - uv.x - uv.y, uv);
	// Written as comparisons that a NaN fails.
	b = vec3(b.x > 0.0 ? min(b.x, 1.0) : 0.0, b.y > 0.0 ? min(b.y, 1.0) : 0.0, b.z > 0.0 ? min(b.z, 1.0) : 0.0);
	float sum = b.x + b.y + b.z;
	return place_seen(first.w, sum > 0.0 ? b.yz / sum : vec2(1.0 / 3.0), t / k, dot(n, a) < 0.0);
}

uint element_of(uint word, vec2 uv, bool front)
{
	if (word == NONE)
		return NONE;
	radiosity_face f = radiosity_faces[word >> RADIOSITY_FACE_SHIFT];
	vec2 inside;
	uint i = patch_at(f, face_place(word, f, uv), inside);
	return front ? i : i + sizes.y / 2u;
}

void count_for(uint row, uint element, uint weight)
{
	uint at = 2u * (row * sizes.y + element);
	uint before = atomicAdd(dense[at], weight);
	if (before + weight < before)
		atomicAdd(dense[at + 1u], 1u);
	// Low bits may come back to 0.
	if (before == 0u && (atomicOr(dense[at + 1u], HEMICUBE_MET) & HEMICUBE_MET) == 0u)
		lists[row * sizes.z + atomicAdd(rows[row].count, 1u)] = element;
}

void count_escaped(uint row, uint weight)
{
	uint before = atomicAdd(rows[row].escaped[0], weight);
	if (before + weight < before)
		atomicAdd(rows[row].escaped[1], 1u);
}

void count_cut(uint row, uint weight)
{
	uint before = atomicAdd(rows[row].cut[0], weight);
	if (before + weight < before)
		atomicAdd(rows[row].cut[1], 1u);
}

#ifdef HEMICUBE_MIRRORS
// What an element reflects of a weight.
uint mirrored(uint element, uint weight)
{
	return min(uint(float(weight) * mirrors[element].share + 0.5), weight);
}
#endif

#endif
