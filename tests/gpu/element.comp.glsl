// The elements of places on triangles. Arrays as long as in test_element.c, which fills them in part.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/radiosity.h"

layout(local_size_x = 64) in;
layout(push_constant) uniform Push {
	uint places;
	uint patches;
} push;
#define PATCH_COUNT push.patches

struct place {
	uint triangle;
	float u, v;
	uint front;
};
struct found {
	uint element;
	float u, v;
};
layout(std430, set = 0, binding = 0) readonly buffer Asked {
	radiosity_face radiosity_faces[64];
	uint radiosity_triangles[128];
	place places[65536];
};
layout(std430, set = 0, binding = 1) writeonly buffer Answers {
	found answers[65536];
};
#include "radiosity/element.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.places)
		return;
	place p = places[i];
	vec2 inside;
	uint word = radiosity_triangles[p.triangle];
	radiosity_face f = radiosity_faces[word >> RADIOSITY_FACE_SHIFT];
	patch_at(f, face_place(word, f, vec2(p.u, p.v)), inside);
	answers[i].element = element_at(p.triangle, vec2(p.u, p.v), p.front != 0u);
	answers[i].u = inside.x;
	answers[i].v = inside.y;
}
