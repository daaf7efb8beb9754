// Which element of radiosity a place on the scene belongs to: the inverse of patches_get (patches.h). The includer declares
// radiosity_faces[] (struct radiosity_face) and radiosity_triangles[] (uint), and the number of patches as PATCH_COUNT; or it
// defines RADIOSITY_PLACES_ONLY, and finds faces by itself.
#ifndef RADIOSITY_ELEMENT_GLSL
#define RADIOSITY_ELEMENT_GLSL

#include "shared/radiosity.h"

// The place (u, v), 0…1, of a quad whose affine place is (x, y), with x along c1 - c0 and y along c3 - c0. It solves
// x = u (1 + a v), y = v (1 + b u), where a = x2 - 1 and b = y2 - 1: a v² + k v - y = 0, of which a convex quad has the root
// with 2 a v + k > 0. Its two forms subtract nothing large; k < 0 implies a > 0.
vec2 quad_place(radiosity_face f, vec2 p)
{
	float a = f.x2 - 1.0;
	float b = f.y2 - 1.0;
	float k = 1.0 + b * p.x - a * p.y;
	float root = sqrt(max(k * k + 4.0 * a * p.y, 0.0));
	float v = k < 0.0 ? (root - k) / (2.0 * a) : 2.0 * p.y / max(k + root, 1e-20);
	return vec2(p.x / max(1.0 + a * v, 1e-20), v);
}

// Where a place on a triangle is in its face: barycentrics of corners 1 and 2 of the triangle in, and out, for a quad its
// (u, v), for a triangle barycentrics of the face's corners 1 and 2.
vec2 face_place(uint word, radiosity_face f, vec2 uv)
{
	vec3 b = vec3(1.0 - uv.x - uv.y, uv);
	uint turn = word & RADIOSITY_FACE_TURN;
	b = turn == 0u ? b : turn == 1u ? b.yzx : b.zxy; // now of the face's corners, from 0
	if (f.v == 0u)
		return b.yz;
	bool second = (word & RADIOSITY_FACE_SECOND) != 0u;
	return quad_place(f, second ? vec2(f.x2 * b.y, f.y2 * b.y + b.z) : vec2(b.y + f.x2 * b.z, f.y2 * b.z));
}

// The patch at a place of face_place, and in `inside` where within the patch: 0…1 along sides 0 1 and 1 2 of a quad's cell; of
// a triangle barycentrics of the patch's corners 1 and 2.
uint patch_at(radiosity_face f, vec2 place, out vec2 inside)
{
	if (f.v != 0u) {
		vec2 cells = clamp(place, 0.0, 1.0) * vec2(f.u, f.v);
		uvec2 cell = min(uvec2(cells), uvec2(f.u, f.v) - 1u);
		inside = clamp(cells - vec2(cell), 0.0, 1.0);
		return f.first + cell.y * f.u + cell.x;
	}
	float n = float(f.u);
	float s = clamp((place.x + place.y) * n, 0.0, n);
	float t = clamp(place.y * n, 0.0, s);
	uint row = min(uint(s), f.u - 1u);
	uint column = min(uint(t), row);
	vec2 r = clamp(vec2(s - float(row), t - float(column)), 0.0, 1.0);
	// Corners of an upright patch: (row, column), (row + 1, column), (row + 1, column + 1); of one on its head: (row, column),
	// (row + 1, column + 1), (row, column + 1).
	bool head = r.y > r.x && column < row;
	r.y = head ? r.y : min(r.y, r.x);
	inside = head ? vec2(r.x, r.y - r.x) : vec2(r.x - r.y, r.y);
	return f.first + row * row + 2u * column + (head ? 1u : 0u);
}

#ifndef RADIOSITY_PLACES_ONLY
// The element of a place on a triangle; NONE: the triangle has no area.
uint element_at(uint id, vec2 uv, bool front)
{
	uint word = radiosity_triangles[id];
	if (word == NONE)
		return NONE;
	radiosity_face f = radiosity_faces[word >> RADIOSITY_FACE_SHIFT];
	vec2 inside;
	uint i = patch_at(f, face_place(word, f, uv), inside);
	return front ? i : i + PATCH_COUNT;
}
#endif

#endif
