// The clear bodies that a path is inside of, the one entered last on top, where its light now travels. What is entered counts
// until it is left, in whatever order: where two bodies overlap, the one entered last is there and the other's boundary
// within it is none. A path may be in four; of more, the one entered first is forgotten. One that starts inside of a body
// learns it where it comes out at the body's back.
#ifndef PATH_MEDIA_GLSL
#define PATH_MEDIA_GLSL

#include "common/surface.glsl"

// Slot i of four, material + 1 or 0; slot 0 is the top.
uint media_slot(uvec2 media, uint i)
{
	return (i < 2u ? media.x : media.y) >> (16u * (i & 1u)) & 0xffffu;
}

bool media_hold(uvec2 media, uint body)
{
	return media_slot(media, 0u) == body || media_slot(media, 1u) == body || media_slot(media, 2u) == body ||
	       media_slot(media, 3u) == body;
}

uvec2 media_with(uvec2 media, uint body)
{
	return uvec2(media.x << 16 | body, media.y << 16 | media.x >> 16);
}

// Without the topmost slot that holds `body`.
uvec2 media_without(uvec2 media, uint body)
{
	bool gone = false;
	uint slots[4];
	for (uint i = 0u; i < 4u; i++) {
		gone = gone || media_slot(media, i) == body;
		slots[i] = media_slot(media, gone ? i + 1u : i);
		slots[i] = gone && i == 3u ? 0u : slots[i];
	}
	return uvec2(slots[0] | slots[1] << 16, slots[2] | slots[3] << 16);
}

float media_index(uvec2 media)
{
	uint body = media_slot(media, 0u);
	return body == 0u ? 1.0 : materials[body - 1u].ior;
}

// The bodies that the path was in before it met s: those it knows, or the one whose back it sees.
uvec2 media_before(uvec2 media, surface s)
{
	return s.body != 0u && !s.front && !media_hold(media, s.body) ? media_with(media, s.body) : media;
}

// Those on the far side of a body's boundary.
uvec2 media_beyond(uvec2 media, surface s)
{
	if (s.body == 0u)
		return media;
	return s.front ? media_with(media, s.body) : media_without(media, s.body);
}

// Whether a surface is clear for this event, and what is on its far side.
uvec2 choose_clear(inout surface s, uvec2 media, float chance)
{
	s.clear = chance < s.transmission;
	uvec2 beyond = media_beyond(media, s);
	float here = media_index(media);
	s.eta = (s.thin ? s.ior : media_index(beyond)) / here;
	return beyond;
}

// What is left of light after `distance` metres.
vec3 media_transmittance(uvec2 media, float distance)
{
	uint body = media_slot(media, 0u);
	if (body == 0u)
		return vec3(1.0);
	return exp(-to_vec3(materials[body - 1u].absorption) * min(distance, 1e30));
}

#endif
