// Voxels of a scene's surfaces: the grid, the bindings, and the contents of an occupied voxel. Used by C and GLSL.
//
// The grid has cubic voxels over the scene's bounding box; cell (x, y, z) is the half-open box low + side · [x, x+1) × [y,
// y+1) × [z, z+1). The longest axis of the box takes resolution − VOXEL_MARGIN voxels and starts at VOXEL_FIRST on every
// axis. So at least one empty voxel is left on each side, and neither the box's faces nor its simple fractions lie on the
// border between two voxels, where rounding would scatter a flat wall over both.
//
// Surfaces that face different ways must not be mixed, or a thin wall would pass the light of one side to the other. So a
// voxel has two layers, by the sign of the largest component of a triangle's counter-clockwise normal (0: positive or none,
// 1: negative). An occupied (cell, layer) pair is an entry. Entries are numbered in the order of their bits,
//     bit = 2 · cell + layer,    entry = words[bit / 32].y + bitCount(words[bit / 32].x below bit % 32).
// So memory use follows occupancy: four bits for each cell, 64 bytes for each entry.
#ifndef CANDIL_SHARED_VOXEL_H
#define CANDIL_SHARED_VOXEL_H

#include "shared/layout.h"

#define VOXEL_MARGIN 2.75
#define VOXEL_FIRST 1.5
#define VOXEL_RESOLUTION_MIN 16
#define VOXEL_RESOLUTION_MAX 512

// A std140 uniform block: two vectors of four.
struct voxel_grid {
	float low[3]; // metres, relative to the blob's origin
	float side; // of a voxel, metres
	uint sides[3]; // cells along each axis, powers of two
	uint entries; // occupied (cell, layer) pairs
};
LAYOUT_ASSERT(voxel_grid, 32)
#define UNIFORM_VOXEL_GRID 0 // uniform block binding

// Storage blocks, beside the scene's.
#define BIND_VOXEL_ITEMS 18 // struct voxel_item; only while voxels are built
#define BIND_VOXEL_BLOCKS 19 // entries in each VOXEL_BLOCK_WORDS words, later those before them; only while voxels are built
#define BIND_VOXEL_WORDS 20 // x: 32 bits, y: entries before them; one more word behind them: x: VOXEL_FULL_…
// Four vectors of four for each entry. Each kind has its own block, because some drivers bind no more than 128 MiB at once.
#define BIND_VOXEL_PLACE \
	21 // xyz: mean position, metres relative to the blob's origin; w: unit normal, octahedral, 2 × 16 bits
#define BIND_VOXEL_ALBEDO 22 // xyz: diffuse albedo, 0…1; w: the entry's bit, an integer
// xyz: radiance of the front, W/(m² sr); w: surface area / side². Behind all entries follows a bit for each: the back
// emits, too.
#define BIND_VOXEL_EMISSION 23
#define BIND_VOXEL_COVERAGE 24 // area / side² projected along x, y, z: (+, −) pairs of half floats; w: 0
#define VOXEL_PARTS 4
#define VOXEL_BACK_BITS 128 // number of such bits in a vector of four
// While they are merged: the sums of what an edit left in place, as words and VOXEL_PARTS blocks.
#define BIND_VOXEL_FIXED_WORDS 25
#define BIND_VOXEL_FIXED_PARTS 26

#define VOXEL_BLOCK_WORDS 64
#define VOXEL_GROUP 64 // invocations; one for each item
#define VOXEL_WORD_GROUP 256 // invocations; one for each word or block of words

// A triangle over a tile of columns. Columns run along `axis`, the axis most parallel to the triangle's normal, so that the
// triangle crosses few cells of a column. Rotated axes (a, b, axis) are (y, z, x), (z, x, y) or (x, y, z).
struct voxel_item {
	uint triangle; // id
	uint tile; // first column a, b: 10 bits each; columns along a, b, less one: 2 bits each; axis: 2 bits; needle: 1 bit
};
LAYOUT_ASSERT(voxel_item, 8)
#define VOXEL_TILE 4 // largest number of columns along each side
#define VOXEL_TILE_B 10
#define VOXEL_TILE_WIDTH 20
#define VOXEL_TILE_HEIGHT 22
#define VOXEL_TILE_AXIS 24
#define VOXEL_TILE_NEEDLE 26
#define VOXEL_NEEDLE 1e-5 // a triangle whose height is less than this share of its length is treated as a line

// Sums are integers, so that they do not depend on the order of additions. If one exceeds 32 bits, the last word says so,
// and the sums are built again in coarser units.
#define VOXEL_FULL_AREA 1u
#define VOXEL_FULL_EMISSION 2u

#endif
