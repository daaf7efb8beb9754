// Form factors by rays: what server/worker/technique/radiosity/rays.c and radiosity/factor_rays.comp.glsl share. Shared by C
// and GLSL.
#ifndef CANDIL_SHARED_FACTOR_RAYS_H
#define CANDIL_SHARED_FACTOR_RAYS_H

#include "shared/radiosity.h"

// Own storage buffers of the pass.
#define BIND_FACTOR_TABLE 22 // uvec4: the rays of an element, in the order in which they are traced
#define BIND_FACTOR_ROWS 23 // uint: the element of each row of the batch
#define BIND_FACTOR_DENSE 24 // uint: rows of as many words as there are elements
#define BIND_FACTOR_SUMS 25 // struct factor_sums, by row
#define BIND_FACTOR_SECONDS 26 // uint, by face: the triangle of a quad's corners 0 2 3, or NONE
#define BIND_FACTOR_TRIANGLES 27 // struct factor_triangle, by triangle, as texels: two of four words
#define BIND_FACTOR_COUNT 28

#define SPEC_FACTOR_MIRRORS 34 // rays go on at mirrors
#define SPEC_FACTOR_BARYCENTRE 35 // all rays of an element start in its barycentre, and the table holds places on the disc
#define SPEC_FACTOR_END 36

#define FACTOR_LANES 64 // of a workgroup

// What finds the element of a hit: a triangle's radiosity_face and its word of BIND_RADIOSITY_TRIANGLES, side by side.
struct factor_triangle {
	float normal[3]; // any length above 0, on the front
	uint first; // NONE: the triangle has no area
	uint u; // in the high FACTOR_WORD_SHIFT bits the word, without its face
	uint v;
	float x2, y2;
};
LAYOUT_ASSERT(factor_triangle, 32)
#define FACTOR_WORD_SHIFT 24u

// Weight of a row that arrived at no element, in units of push.weight / rays.
struct factor_sums {
	uint escaped; // met nothing
	uint cut; // of a limit of bounces
};
LAYOUT_ASSERT(factor_sums, 8)

struct factor_push {
	uint patches; // of the scene
	uint first_row; // of this dispatch
	uint rays; // of an element
	uint turns; // that a lane does one after the other: BUNDLE_RAYS rays in a packet, else one
	uint weight; // of a ray when it starts
	uint bounces; // at mirrors, that a ray does at most
};
LAYOUT_ASSERT(factor_push, 24)

#endif
