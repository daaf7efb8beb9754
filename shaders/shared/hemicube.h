// Hemicubes: what server/worker/technique/radiosity/hemicube.c and radiosity/hemicube*.glsl share. Used by C and GLSL.
//
// A cell is the picture of one hemicube of n × n pixels: three layers of n × n texels, of the top, of the sides +x and −x,
// and of the sides +y and −y. Of two sides the first has the layer's lower half. Pixels are numbered layer by layer.
#ifndef CANDIL_SHARED_HEMICUBE_H
#define CANDIL_SHARED_HEMICUBE_H

#include "shared/radiosity.h"

#define HEMICUBE_FACES 5
#define HEMICUBE_LAYERS 3 // of a cell
#define HEMICUBE_LANES 64 // of a workgroup
#define HEMICUBE_RUN 8u // pixels that a lane of the sum looks at

// Storage blocks of the passes.
#define BIND_HEMICUBE_CELLS 22 // struct hemicube_cell, by cell
#define BIND_HEMICUBE_DENSE 23 // uint: rows of two words for each element: a sum's low bits, and its high bits with a flag
#define BIND_HEMICUBE_ROWS 24 // struct hemicube_row, by row
#define BIND_HEMICUBE_LISTS 25 // uint: for each row room for the elements that it has met, in no order
#define BIND_HEMICUBE_ENTRIES 26 // struct hemicube_entry, row by row
#define BIND_HEMICUBE_MIRRORS 27 // struct hemicube_mirror, by element
#define BIND_HEMICUBE_SEEN 28 // uint: for each cell eight bits for each plane of mirrors, one for each face that sees it

#define BIND_HEMICUBE_PIXELS \
	28 // struct hemicube_pixels; then for each pixel its number among all of the pass, and its weight

#define UNIT_HEMICUBE_IDS 0 // texture: triangle + 1, or 0
#define UNIT_HEMICUBE_TABLE 1 // texel buffer: uint, hemicube_table.h
#define UNIT_HEMICUBE_TRIANGLES 2 // texel buffer: three of struct hemicube_corner by triangle
#define UNIT_HEMICUBE_PARENTS 3 // texture: what the cells of one mirror fewer have found: plane + 1, weight that goes on
#define UNIT_HEMICUBE_CELLS 4 // texel buffer: HEMICUBE_CELL_TEXELS of vec4 by cell
#define HEMICUBE_CELL_TEXELS 5
#define IMAGE_HEMICUBE_FOUND 0 // image: the same of these cells

#define HEMICUBE_SIZES 8 // uniform location, uvec3: n, elements, elements that a row has room for
#define HEMICUBE_BOUNCES 9 // uniform location, uvec2: mirrors on the way so far, mirrors at most
#define HEMICUBE_NEAR 10 // uniform location, float: metres
#define HEMICUBE_PLANES 11 // uniform location, uint: words of a cell in BIND_HEMICUBE_SEEN

// A hemicube about a point, perhaps as mirrors show it. Metres, relative to the blob's origin.
struct hemicube_cell {
	float eye[3];
	uint row; // of the batch
	float x[3]; // the frame: z is the element's normal
	uint parent; // the cell that sees it in a mirror, by number in its pass
	float y[3];
	uint plane; // of that mirror + 1; 0: no mirror
	float z[3];
	float unused;
	float clip[4]; // of what is in front of the mirror: clip.xyz · (p − eye) + clip.w is above 0
};
LAYOUT_ASSERT(hemicube_cell, 80)

// A corner of a triangle.
struct hemicube_corner {
	float at[3];
	uint word; // of the first: RADIOSITY_FACE_…
};
LAYOUT_ASSERT(hemicube_corner, 16)

// What is known of a row beside its entries. Sums have two words, the low one first.
struct hemicube_row {
	uint escaped[2]; // weight that met nothing
	uint cut[2]; // weight that a limit of mirrors cut off
	uint count; // elements that it has met
	uint first; // of its entries
};
LAYOUT_ASSERT(hemicube_row, 24)

struct hemicube_entry {
	uint element;
	uint weight[2];
};
LAYOUT_ASSERT(hemicube_entry, 12)

#define HEMICUBE_MET 0x80000000u // bit of a high word of the dense rows: the element is in the row's list

// Pixels at mirrors, whose light goes on by rays.
struct hemicube_pixels {
	uint groups[3]; // of the dispatch that follows them
	uint count;
	uint cut; // 1: the driver ended a loop
	uint unused;
};
LAYOUT_ASSERT(hemicube_pixels, 24)

struct hemicube_mirror {
	uint plane; // + 1; 0: it is no mirror
	float share; // that it reflects
};
LAYOUT_ASSERT(hemicube_mirror, 8)

#endif
