// Where the rays of an element of radiosity start and whereto: places spread evenly over its area, directions by the cosine
// about its normal. The includer declares radiosity_patches[] (struct radiosity_patch), factor_table[] (uvec4) and
// factor_seconds[] (uint).
//
// The rays of all elements are one low-discrepancy set in four dimensions, of which each element has its own Cranley-Patterson
// rotation (1976: each dimension is shifted, modulo 1, by a hash of the element). Neighbours in the table have neighbouring
// directions, and but for those that a shift wraps round the rotation leaves them neighbours.
//
// No ray starts on what another body covers of an element (cover.glsl). The area from which F is then taken is the one at which
// others look, so that reciprocity holds by it.
#ifndef RADIOSITY_FACTOR_SOURCE_GLSL
#define RADIOSITY_FACTOR_SOURCE_GLSL

#include "common/sampling.glsl"
#include "common/surface.glsl"
#include "radiosity/cover.glsl"
#include "shared/factor_rays.h"

layout(constant_id = SPEC_FACTOR_BARYCENTRE) const bool BARYCENTRE = false;

// Share of start_offset by which rays start farther off: corners of a patch are rounded once more than those of its triangles,
// and a quad's two triangles lie in one plane but for rounding (patch_faces.h).
const float SOURCE_OFFSET = 1.25;

// Least cosine to the normal: rounding could turn a direction below it to the element's own plane. One ray in 10⁸ has less.
const float SOURCE_COSINE = 1e-4;

struct factor_source {
	vec3 corner[4];
	vec3 inward[4];   // unit, in the patch's plane, away from the edge that begins at each corner; of an edge of no length 0
	vec3 normal;      // unit, on the element's side
	vec3 x, y;        // with the normal, a frame
	float share;      // of the triangle of corners 0 1 2 in the area
	uint covered;     // parts from which no ray starts: covers_part
	bool quad;
	uvec4 shift;
	corners first;    // the triangles of its face; of a face of one the same
	corners second;
};

vec3 edge_inward(vec3 a, vec3 b, vec3 normal)
{
	vec3 d = b - a;
	vec3 m = abs(d);
	vec3 n = cross(normal, d / max(max(m.x, max(m.y, m.z)), 1e-30));
	return n / max(length(n), 1e-30);
}

factor_source source_make(uint element, uint patch_count)
{
	bool front = element < patch_count;
	radiosity_patch p = radiosity_patches[front ? element : element - patch_count];
	uint second = factor_seconds[p.face];
	factor_source s;
	for (uint i = 0u; i < 4u; i++)
		s.corner[i] = vec3(p.corner[3u * i], p.corner[3u * i + 1u], p.corner[3u * i + 2u]);
	s.first = corners_of(triangles[p.triangle]);
	s.second = corners_of(triangles[second == NONE ? p.triangle : second]);
	for (uint i = 0u; i < 4u; i++)
		s.inward[i] = edge_inward(s.corner[i], s.corner[(i + 1u) & 3u], s.first.normal);
	s.normal = front ? s.first.normal : -s.first.normal;
	frame_make(s.normal, s.x, s.y);
	s.share = p.share;
	s.covered = front ? covers_part(p.covered) : 0u;
	s.quad = s.corner[3] != s.corner[2];
	for (uint i = 0u; i < 4u; i++)
		s.shift[i] = hash_combine(hash(element), i);
	return s;
}

// The same where parts are covered, by the map of patch_point_at. Of a quad that is no parallelogram places are somewhat closer
// to each other where it is narrow.
vec3 source_uncovered(factor_source s, vec2 u)
{
	u = cover_avoid(s.covered, u);
	vec2 b = s.quad ? u : sample_triangle(u);
	vec3 triangle = (1.0 - b.x - b.y) * s.corner[0] + b.x * s.corner[1] + b.y * s.corner[2];
	return s.quad ? mix(mix(s.corner[0], s.corner[1], u.x), mix(s.corner[3], s.corner[2], u.x), u.y) : triangle;
}

// The place for two numbers of [0, 1): the first also chooses between the two triangles that the patch is of.
vec3 source_place(factor_source s, vec2 u)
{
	if (s.covered != 0u)
		return source_uncovered(s, u);
	bool second = u.x >= s.share;
	u.x = second ? (u.x - s.share) / (1.0 - s.share) : u.x / s.share;
	u = sample_triangle(u);
	return (1.0 - u.x - u.y) * s.corner[0] + u.x * (second ? s.corner[2] : s.corner[1]) +
	       u.y * (second ? s.corner[3] : s.corner[2]);
}

vec3 source_barycentre(factor_source s)
{
	return (s.corner[0] + s.corner[2] + s.share * s.corner[1] + (1.0 - s.share) * s.corner[3]) / 3.0;
}

// The ray of a row of the table. It starts off the plane, and inside of all edges, by more than rounding: see point_inside.
void source_ray(factor_source s, uint row, out vec3 origin, out vec3 direction)
{
	uvec4 words = factor_table[row];
	uvec4 bits = words + s.shift;
	vec4 u = vec4(bits >> 8) * UNIT_24;
	vec2 disc = BARYCENTRE ? uintBitsToFloat(words.xy) : concentric_disc(u.xy);
	vec3 p = BARYCENTRE ? source_barycentre(s) : source_place(s, u.zw);
	float offset = max(start_offset(s.first, p), start_offset(s.second, p));
	float clearance = 4.0 * offset;
	vec3 away = vec3(0.0);
	for (uint i = 0u; i < 4u; i++)
		away += s.inward[i] * (s.inward[i] == vec3(0.0)
					   ? 0.0
					   : clamp(clearance - dot(p - s.corner[i], s.inward[i]), 0.0, clearance));
	float cosine = max(sqrt(max(1.0 - dot(disc, disc), 0.0)), SOURCE_COSINE);
	origin = p + away + SOURCE_OFFSET * offset * s.normal;
	direction = disc.x * s.x + disc.y * s.y + cosine * s.normal;
}

#endif
