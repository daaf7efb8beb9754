// The faces of an OBJ file: from its words to triangles and vertices of the import. One thread.
#ifndef CANDIL_LOADER_OBJ_FACES_H
#define CANDIL_LOADER_OBJ_FACES_H

#include "server/loader/key_table.h"
#include "server/loader/obj_points.h"
#include "server/loader/obj_polygon.h"

// How many of each list stand before a face: its negative indices count back from there.
struct obj_counts {
	size_t positions, uvs, normals;
};

struct obj_faces {
	struct import *import;
	const struct obj_points *points;
	struct key_table vertices; // by position, coordinates, normal, material and group
	struct obj_polygon polygon;
	struct obj_corner *corners; // of the face that is read
	size_t corner_room;
	bool told_attribute; // of an index that names nothing
};

// Set up an import's faces. `import` and `points` must outlive them.
void obj_faces_init(struct obj_faces *faces, struct import *import, const struct obj_points *points);
void obj_faces_finish(struct obj_faces *faces);

// Read a face behind its keyword and add its triangles. Corners that are equal in all that they name, in faces of the same
// material and group, are one vertex. A face in a smoothing group whose corners lack normals is told. STATUS_SCENE_INVALID:
// what is no index, or a vertex that is not there. STATUS_SCENE_LIMIT, STATUS_MEMORY.
enum status obj_faces_read(struct obj_faces *faces, struct obj_text *text, const struct obj_counts *before,
			   uint32_t material, uint32_t group, bool is_smooth, struct error *err);

#endif
