// The parts of a patch that lie inside of other bodies: radiosity_patch.covered has two bits for each of PATCH_COVER_SIDE² equal
// parts of the unit square that is mapped to the patch. Who reads them decides what counts (covers_part): they are never
// rewritten, so that jobs which share them see the same.
#ifndef RADIOSITY_COVER_GLSL
#define RADIOSITY_COVER_GLSL

#include "shared/radiosity.h"

// The bits that count. Those of a patch that is covered as a whole do not. Nor do those of a patch some open part of which
// meets mostly backs: what it looks at is wound the other way, and backs tell nothing there.
uint covers_part(uint covered)
{
	uint inside = covered & PATCH_COVER_ALL;
	uint doubtful = covered >> PATCH_COVER_PARTS & ~inside;
	return inside == PATCH_COVER_ALL || doubtful != 0u ? 0u : inside;
}

vec2 cover_middle(uint part)
{
	return (vec2(part % PATCH_COVER_SIDE, part / PATCH_COVER_SIDE) + 0.5) / float(PATCH_COVER_SIDE);
}

// Whether a place of the unit square is in a covered part.
bool cover_has(uint covered, vec2 u)
{
	uvec2 at = min(uvec2(u * float(PATCH_COVER_SIDE)), uvec2(PATCH_COVER_SIDE - 1u));
	return (covers_part(covered) >> (at.y * PATCH_COVER_SIDE + at.x) & 1u) != 0u;
}

// The number of the set bit of `bits` before which `n` others are.
uint bit_after(uint bits, uint n)
{
	uint base = 0u;
	for (uint step = 16u; step > 0u; step /= 2u) {
		uint before = uint(bitCount(bits & ((1u << step) - 1u)));
		bool beyond = n >= before;
		n -= beyond ? before : 0u;
		bits = beyond ? bits >> step : bits;
		base += beyond ? step : 0u;
	}
	return base;
}

// Moves a place of the unit square, evenly, to what is not covered: the first number chooses the part.
vec2 cover_avoid(uint covered, vec2 u)
{
	uint open = PATCH_COVER_ALL & ~covers_part(covered);
	float at = u.x * float(bitCount(open));
	uint part = bit_after(open, min(uint(at), uint(bitCount(open)) - 1u));
	return cover_middle(part) + (vec2(fract(at), u.y) - 0.5) / float(PATCH_COVER_SIDE);
}

#endif
