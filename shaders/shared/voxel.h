// Voxels of a scene's surfaces, for C and GLSL: the grid, the bindings, and what is kept of each occupied voxel.
//
// The grid. Cubic voxels over the scene's bounding box; cell (x, y, z) is the half-open box
// low + side · [x, x+1) × [y, y+1) × [z, z+1). The longest axis of the box takes resolution − VOXEL_MARGIN voxels and starts
// at VOXEL_FIRST on every axis: at least one empty voxel is left on each side, and neither the box's faces nor its simple
// fractions lie on the border between two voxels, where rounding would scatter a flat wall over both.
//
// Entries. What faces different ways must not be mixed, or a thin wall would hand the light of one side to the other: a
// voxel has two layers, by the sign of the largest component of a triangle's counter-clockwise normal (0: positive or none,
// 1: negative). An occupied (cell, layer) pair is an entry. Entries are numbered in the order of their bits,
//     bit = 2 · cell + layer,    entry = words[bit / 32].y + bitCount(words[bit / 32].x below bit % 32)
// so memory goes to what is occupied: four bits a cell, 64 bytes an entry.
#ifndef CANDIL_SHARED_VOXEL_H
#define CANDIL_SHARED_VOXEL_H

#include "shared/layout.h"

#define VOXEL_MARGIN 2.75
#define VOXEL_FIRST 1.5
#define VOXEL_RESOLUTION_MIN 16
#define VOXEL_RESOLUTION_MAX 512

// A uniform block, std140: two vectors of four.
struct voxel_grid {
	float low[3]; // metres, relative to the blob's origin
	float side; // of a voxel, metres
	uint sides[3]; // cells along each axis, powers of two
	uint entries; // occupied (cell, layer) pairs
};
LAYOUT_ASSERT(voxel_grid, 32)
#define UNIFORM_VOXEL_GRID 0 // uniform block binding

// Storage blocks, beside the scene's.
#define BIND_VOXEL_ITEMS 18 // struct voxel_item; while voxels are made
#define BIND_VOXEL_BLOCKS 19 // entries of each VOXEL_BLOCK_WORDS words, summed up; while voxels are made
#define BIND_VOXEL_WORDS 20 // x: 32 bits, y: entries before them; one more behind them: x: VOXEL_FULL_…
// Four vectors of four an entry, each kind in a block of its own (some drivers bind no more than 128 MiB at once).
#define BIND_VOXEL_PLACE \
	21 // xyz: mean position, metres relative to the blob's origin; w: unit normal, octahedral, 2 × 16 bits
#define BIND_VOXEL_ALBEDO 22 // xyz: diffuse albedo, 0…1; w: the entry's bit, an integer
// xyz: radiance, W/(m² sr), of the front; w: surface area / side². Behind all entries a bit each: the back emits, too
#define BIND_VOXEL_EMISSION 23
#define BIND_VOXEL_COVERAGE 24 // area / side² projected along x, y, z: (+, −) pairs of half floats; w: 0
#define VOXEL_PARTS 4
#define VOXEL_BACK_BITS 128 // of such bits in a vector of four
// The sums of what an edit left in place, while they are merged: words, and VOXEL_PARTS blocks.
#define BIND_VOXEL_FIXED_WORDS 25
#define BIND_VOXEL_FIXED_PARTS 26

#define VOXEL_BLOCK_WORDS 64
#define VOXEL_GROUP 64 // invocations, one an item
#define VOXEL_WORD_GROUP 256 // invocations, one a word or a block of words

// A triangle over a tile of columns. Columns run along `axis`, the one that the triangle faces most, so that a column meets
// it in few cells; rotated axes (a, b, axis) are (y, z, x), (z, x, y) or (x, y, z).
struct voxel_item {
	uint triangle; // id
	uint tile; // first column a, b: 10 bits each; columns along a, b less one: 2 bits each; axis: 2 bits; needle: 1 bit
};
LAYOUT_ASSERT(voxel_item, 8)
#define VOXEL_TILE 4 // columns along each side at most
#define VOXEL_TILE_B 10
#define VOXEL_TILE_WIDTH 20
#define VOXEL_TILE_HEIGHT 22
#define VOXEL_TILE_AXIS 24
#define VOXEL_TILE_NEEDLE 26
#define VOXEL_NEEDLE 1e-5 // a triangle whose height is less than so many times its length is taken for a line

// Sums are integers, for their order must not matter. Where they would pass 32 bits the last word tells, and
// they are made again, coarser.
#define VOXEL_FULL_AREA 1u
#define VOXEL_FULL_EMISSION 2u

#endif
