// What is known of elements, by a place on a triangle, on OpenGL: a value of the element, or one between those of its corners.
#ifndef RADIOSITY_LOOKUP_GLSL
#define RADIOSITY_LOOKUP_GLSL

#define RADIOSITY_PLACES_ONLY
#include "radiosity/element.glsl"
#include "shared/radiosity_show.h"

// Whether there are values of corners; a macro that the program defines.
#ifndef RADIOSITY_CORNERS
#define RADIOSITY_CORNERS true
#endif

layout(binding = RADIOSITY_FACES_UNIT) uniform usamplerBuffer radiosity_faces;
layout(binding = RADIOSITY_TRIANGLES_UNIT) uniform usamplerBuffer radiosity_triangles;
layout(binding = RADIOSITY_VALUES_UNIT) uniform samplerBuffer radiosity_values;
layout(location = RADIOSITY_PATCHES) uniform uint radiosity_patches;

radiosity_face face_fetch(uint face)
{
	int at = int(face) * RADIOSITY_FACE_WORDS;
	radiosity_face f;
	f.first = texelFetch(radiosity_faces, at).x;
	f.u = texelFetch(radiosity_faces, at + 1).x;
	f.v = texelFetch(radiosity_faces, at + 2).x;
	f.x2 = uintBitsToFloat(texelFetch(radiosity_faces, at + 3).x);
	f.y2 = uintBitsToFloat(texelFetch(radiosity_faces, at + 4).x);
	return f;
}

// The value at barycentrics uv (of corners 1 and 2) of triangle `id`, seen from its front or its back; zero for a triangle
// that has no area.
vec3 value_at(uint id, vec2 uv, bool front)
{
	uint word = texelFetch(radiosity_triangles, int(id)).x;
	bool none = word == NONE;
	radiosity_face f = face_fetch(none ? 0u : word >> RADIOSITY_FACE_SHIFT);
	vec2 p;
	int at = 3 * int(patch_at(f, face_place(word, f, uv), p) + (front ? 0u : radiosity_patches));
	vec3 value;
	if (RADIOSITY_CORNERS) {
		// Three texels hold the colours of four corners.
		vec4 a = texelFetch(radiosity_values, at);
		vec4 b = texelFetch(radiosity_values, at + 1);
		vec4 c = texelFetch(radiosity_values, at + 2);
		bool quad = f.v != 0u;
		float far = quad ? p.x * p.y : p.y;
		float left = quad ? p.y - far : 0.0;
		float right = quad ? p.x - far : p.x;
		value = (1.0 - far - left - right) * a.xyz + right * vec3(a.w, b.xy) + far * vec3(b.zw, c.x) + left * c.yzw;
	} else {
		value = vec3(texelFetch(radiosity_values, at).x, texelFetch(radiosity_values, at + 1).x,
			     texelFetch(radiosity_values, at + 2).x);
	}
	return none ? vec3(0.0) : value;
}

#endif
