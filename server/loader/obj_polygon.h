// Cuts polygons into triangles, concave ones too, in a time that grows about as the number of corners. One thread.
#ifndef CANDIL_LOADER_OBJ_POLYGON_H
#define CANDIL_LOADER_OBJ_POLYGON_H

#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

// The steps that all faces of a file together may take beyond what their corners need: seconds. Only a polygon of tens of
// thousands of corners that is all folds takes so many.
#define OBJ_POLYGON_STEPS (1ull << 30)

struct obj_polygon {
	double (*corners)[3]; // the caller fills them in, `count` of them
	uint32_t count;
	uint32_t (*triangles)[3]; // after obj_polygon_cut: numbers of corners, count - 2 triangles
	struct obj_polygon_work *work;
	size_t room, work_room;
	uint64_t steps;
};

// Make room for `count` corners in all, at most LIMIT_TRIANGLES. STATUS_SCENE_LIMIT, STATUS_MEMORY.
enum status obj_polygon_reserve(struct obj_polygon *polygon, size_t count, struct error *err);

// Cut the polygon, which has three corners or more. A convex one becomes a fan about its first corner. One that crosses
// itself or has no plane is cut somehow. STATUS_SCENE_LIMIT: it would take too many steps. STATUS_MEMORY.
enum status obj_polygon_cut(struct obj_polygon *polygon, struct error *err);

// Free everything.
void obj_polygon_finish(struct obj_polygon *polygon);

#endif
