// The clear bodies that contain a path's position. They form a stack; its top is the body in which the light now travels. A
// body counts from entering until leaving, in whatever order. Where bodies overlap, the one of the highest priority exists;
// of equal priorities, the one entered last (Schmidt and Budge 2002, "Simple nested dielectrics in ray traced images"). The
// stack is kept in that order. A boundary inside a body of higher priority does not exist: it counts as an event but leaves
// light as it is.
//
// A path may be in four bodies. If it enters more, the lowest in the stack is forgotten. A path that starts inside a body
// learns so when it reaches the body's back.
#ifndef PATH_MEDIA_GLSL
#define PATH_MEDIA_GLSL

#include "common/surface.glsl"

// Slot i of four: material + 1, or 0. Slot 0 is the top.
uint media_slot(uvec2 media, uint i)
{
	return (i < 2u ? media.x : media.y) >> (16u * (i & 1u)) & 0xffffu;
}

bool media_hold(uvec2 media, uint body)
{
	return media_slot(media, 0u) == body || media_slot(media, 1u) == body || media_slot(media, 2u) == body ||
	       media_slot(media, 3u) == body;
}

uint media_priority(uint body)
{
	return materials[max(body, 1u) - 1u].flags >> MATERIAL_PRIORITY_SHIFT;
}

uvec2 media_packed(uint slots[4])
{
	return uvec2(slots[0] | slots[1] << 16, slots[2] | slots[3] << 16);
}

// The stack with `body` on top, or beneath those of a higher priority.
uvec2 media_with(uvec2 media, uint body)
{
	if (!PRIORITIES)
		return uvec2(media.x << 16 | body, media.y << 16 | media.x >> 16);
	uint priority = media_priority(body);
	uint slots[4];
	bool placed = false;
	for (uint i = 0u; i < 4u; i++) {
		uint here = media_slot(media, i);
		placed = placed || here == 0u || media_priority(here) <= priority;
		slots[i] = placed ? body : here;
		body = placed ? here : body;
	}
	return media_packed(slots);
}

// The stack without the topmost slot that holds `body`.
uvec2 media_without(uvec2 media, uint body)
{
	bool gone = false;
	uint slots[4];
	for (uint i = 0u; i < 4u; i++) {
		gone = gone || media_slot(media, i) == body;
		slots[i] = media_slot(media, gone ? i + 1u : i);
		slots[i] = gone && i == 3u ? 0u : slots[i];
	}
	return media_packed(slots);
}

float media_index(uvec2 media)
{
	uint body = media_slot(media, 0u);
	return body == 0u ? 1.0 : materials[body - 1u].ior;
}

// Whether s is the back of a body that the path did not know to contain it.
bool media_lacks(uvec2 media, surface s)
{
	return s.body != 0u && !s.front && !media_hold(media, s.body);
}

// The bodies that contained the path before it hit s: those in the stack, and the one whose back was hit. A boundary that
// does not exist becomes one that leaves light as it is.
uvec2 media_before(uvec2 media, inout surface s)
{
	if (media_lacks(media, s))
		media = media_with(media, s.body);
	uint top = media_slot(media, 0u);
	if (PRIORITIES && s.body != 0u && top != 0u && media_priority(top) > media_priority(s.body)) {
		s.transmission = 1.0;
		s.base = vec3(1.0);
		s.shading = s.geometric;
	}
	return media;
}

// The bodies on the far side of a body's boundary.
uvec2 media_beyond(uvec2 media, surface s)
{
	if (s.body == 0u)
		return media;
	return s.front ? media_with(media, s.body) : media_without(media, s.body);
}

// Decides whether a surface is clear for this event. Returns the bodies on its far side.
uvec2 choose_clear(inout surface s, uvec2 media, float chance)
{
	s.clear = chance < s.transmission;
	uvec2 beyond = media_beyond(media, s);
	float here = media_index(media);
	s.eta = (s.thin ? s.ior : media_index(beyond)) / here;
	return beyond;
}

// Transmittance of the path's medium over `distance` metres.
vec3 media_transmittance(uvec2 media, float distance)
{
	uint body = media_slot(media, 0u);
	if (body == 0u)
		return vec3(1.0);
	return exp(-to_vec3(materials[body - 1u].absorption) * min(distance, 1e30));
}

#endif
