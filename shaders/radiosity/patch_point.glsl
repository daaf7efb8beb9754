// The patches of a pass of shared/patch_pass.h; points of a patch, and where on the scene's triangles they are: the inverse of
// element.glsl.
#ifndef RADIOSITY_PATCH_POINT_GLSL
#define RADIOSITY_PATCH_POINT_GLSL

#include "common/sampling.glsl"
#include "radiosity/cover.glsl"
#include "shared/patch_pass.h"

// The pass that finds what is covered writes it into the patches.
#ifdef PATCHES_WRITTEN
#define PATCHES_ACCESS
#else
#define PATCHES_ACCESS readonly
#endif

layout(std430, set = 0, binding = BIND_RADIOSITY_FACES) readonly buffer Faces {
	radiosity_face radiosity_faces[];
};
layout(std430, set = 0, binding = BIND_RADIOSITY_TRIANGLES) readonly buffer FaceWords {
	uint radiosity_triangles[];
};
layout(std430, set = 0, binding = BIND_RADIOSITY_PATCHES) PATCHES_ACCESS buffer Patches {
	radiosity_patch radiosity_patches[];
};
layout(std430, set = 0, binding = BIND_PATCH_TRIANGLES) readonly buffer FaceTriangles {
	uvec2 patch_triangles[];
};

struct patch_point {
	uint id;       // of the triangle
	vec2 uv;       // barycentrics of its corners 1 and 2
	float weight;  // area that a point stands for, over the mean of all points
};

// Point `i` of `count`, a power of two, in the unit square: Hammersley's set (1960), moved by half a step, so that on either
// axis points are in the middle of equal parts. The mean of what is linear is exact, and that of a step is off by less than
// one in `count`.
vec2 square_point(uint i, uint count)
{
	float turned = float(bitfieldReverse(i) >> 8) * UNIT_24;
	return vec2(float(i) + 0.5, turned * float(count) + 0.5) / float(count);
}

// The point of a face at a place of face_place (element.glsl): barycentrics of its corners 0, 1 and 2, or in `second` of 0, 2
// and 3. A quad is cut along 0 2: in units of its sides at corner 0 the diagonal's end is (x2, y2).
vec3 face_barycentrics(radiosity_face f, vec2 place, out bool second)
{
	second = false;
	if (f.v == 0u)
		return vec3(1.0 - place.x - place.y, place);
	vec2 p = vec2(place.x * (1.0 + (f.x2 - 1.0) * place.y), place.y * (1.0 + (f.y2 - 1.0) * place.x));
	second = p.y * f.x2 > p.x * f.y2;
	vec2 b = second ? vec2(p.x / f.x2, p.y - p.x * f.y2 / f.x2) : vec2(p.x - p.y * f.x2 / f.y2, p.y / f.y2);
	return vec3(1.0 - b.x - b.y, b);
}

// How a quad's cell is stretched at a place: the determinant of the map from (u, v) to the plane.
float quad_stretch(radiosity_face f, vec2 place)
{
	return 1.0 + (f.x2 - 1.0) * place.y + (f.y2 - 1.0) * place.x;
}

// The place in its face of a point of a triangle's patch: `inside` are barycentrics of the patch's corners 1 and 2, `n` the
// parts of a side and `i` the patch's number among the face's.
vec2 triangle_place(uint i, uint n, vec2 inside)
{
	uint row = uint(sqrt(float(i)));
	row -= row * row > i ? 1u : 0u;
	row += (row + 1u) * (row + 1u) <= i ? 1u : 0u;
	uint r = i - row * row;
	bool head = (r & 1u) != 0u;
	float s = float(row) + (head ? inside.x : inside.x + inside.y);
	float t = float(r >> 1) + (head ? inside.x + inside.y : inside.y);
	return vec2(s - t, t) / float(n);
}

// The point of patch `i` for a point u of the unit square. `face` is radiosity_patch.face.
patch_point patch_point_at(uint i, uint face, vec2 u)
{
	radiosity_face f = radiosity_faces[face];
	patch_point p;
	vec2 place;
	p.weight = 1.0;
	if (f.v != 0u) {
		vec2 parts = vec2(f.u, f.v);
		vec2 cell = vec2((i - f.first) % f.u, (i - f.first) / f.u);
		place = (cell + u) / parts;
		p.weight = quad_stretch(f, place) / quad_stretch(f, (cell + 0.5) / parts);
	} else
		place = triangle_place(i - f.first, f.u, sample_triangle(u));
	bool second;
	vec3 b = face_barycentrics(f, place, second);
	uvec2 ids = patch_triangles[face];
	p.id = second ? ids.y : ids.x;
	uint turn = radiosity_triangles[p.id] & RADIOSITY_FACE_TURN;
	b = max(turn == 0u ? b : turn == 1u ? b.zxy : b.yzx, vec3(0.0));
	p.uv = b.yz / (b.x + b.y + b.z);
	return p;
}

#endif
