// Cuts polygons into triangles, whatever their shape: n corners take n log n comparisons and no more. One thread.
#ifndef CANDIL_LOADER_OBJ_POLYGON_H
#define CANDIL_LOADER_OBJ_POLYGON_H

#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

struct obj_polygon {
	double (*corners)[3]; // the caller fills them in, `count` of them
	uint32_t count;
	uint32_t (*triangles)[3]; // after obj_polygon_cut: numbers of corners, count - 2 triangles
	size_t room;
	uint64_t comparisons; // of places, since the beginning
};

// Make room for `count` corners in all, at most LIMIT_TRIANGLES. STATUS_SCENE_LIMIT, STATUS_MEMORY.
enum status obj_polygon_reserve(struct obj_polygon *polygon, size_t count, struct error *err);

// Cut the polygon, which has three corners or more, seen along the axis along which it is largest. Each side of it is a side
// of one triangle, each other side is shared by two, and all turn as it does, so that the vectors of their areas add up to
// its own. Where it does not cross itself, no triangles overlap: it may touch itself, and have holes and further parts by
// way of sides that lead there and back. One that turns left at every corner becomes a fan about its first corner, and so
// does one without area. One that crosses itself is cut as well as its order lets it, and has triangles that turn the other
// way. Corners that add nothing are triangles without area. STATUS_MEMORY.
enum status obj_polygon_cut(struct obj_polygon *polygon, struct error *err);

// Free everything.
void obj_polygon_finish(struct obj_polygon *polygon);

#endif
