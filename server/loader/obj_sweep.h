// Finds where a polygon is to be cut into pieces that rise on two sides: a line sweeps over its corners from below (Garey,
// Johnson, Preparata and Tarjan, "Triangulating a simple polygon", 1978). One thread.
#ifndef CANDIL_LOADER_OBJ_SWEEP_H
#define CANDIL_LOADER_OBJ_SWEEP_H

#include <stdbool.h>
#include <stdint.h>

#include "server/base/error.h"

// Coordinates are whole numbers of at most this many bits and a sign, so that areas, and sums of LIMIT_TRIANGLES of them,
// are exact.
#define OBJ_SWEEP_BITS 48

__extension__ typedef __int128 obj_area;

// A corner of the polygon: counterclockwise, not where one beside it is.
struct obj_sweep_corner {
	int64_t at[2];
	uint32_t rank; // obj_sweep fills it in: its place in the order of the sweep
	uint32_t interval; // of the side to the next corner; the sweep's own
	uint32_t corner, place; // for whoever calls
};

// The polygon's cuts: pairs of corners, at most as many as it has corners.
struct obj_sweep_cut {
	uint32_t from, to; // from < to
};

// Twice the area of a triangle, positive if it is counterclockwise.
static inline obj_area obj_sweep_area(const int64_t a[2], const int64_t b[2], const int64_t c[2])
{
	return (obj_area)(b[0] - a[0]) * (c[1] - a[1]) - (obj_area)(b[1] - a[1]) * (c[0] - a[0]);
}

// The order of the sweep: upwards, and of what is equally high to the right.
static inline int obj_sweep_compare(const int64_t a[2], const int64_t b[2])
{
	return a[1] != b[1] ? (a[1] < b[1] ? -1 : 1) : (a[0] > b[0]) - (a[0] < b[0]);
}

// Find the cuts of `count` corners, in no order, and add to *comparisons. If the polygon does not cross itself, no two cuts
// cross, and each piece has one lowest and one highest corner by rank. STATUS_MEMORY.
enum status obj_sweep(struct obj_sweep_corner *corners, uint32_t count, struct obj_sweep_cut *cuts, uint32_t *cut_count,
		      uint64_t *comparisons, struct error *err);

#endif
