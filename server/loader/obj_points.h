// The lists that an OBJ file's faces point into: vertices with their colours, coordinates of maps and normals. One thread.
#ifndef CANDIL_LOADER_OBJ_POINTS_H
#define CANDIL_LOADER_OBJ_POINTS_H

#include "server/loader/import.h"
#include "server/loader/obj_text.h"

struct obj_points {
	double (*positions)[3];
	float (*colours)[3]; // NULL: no vertex has any
	float (*uvs)[2];
	float (*normals)[3];
	size_t position_count, position_room, colour_room;
	size_t uv_count, uv_room;
	size_t normal_count, normal_room;
	double largest_colour; // component of a colour
	bool has_broken_colour; // one with a fraction
	// After obj_points_end, for each of a list the same number if they are equal in every bit, colours too. Exporters
	// write the same corner again and again.
	uint32_t *distinct_position, *distinct_uv, *distinct_normal;
};

// Read a v, vt or vn behind its keyword. *known becomes false for any other keyword, of which nothing is read. One that
// lacks numbers is told and keeps its place in the list; a vertex without a place then is not finite. STATUS_SCENE_LIMIT,
// STATUS_MEMORY.
enum status obj_points_read(struct obj_points *points, struct import *import, struct obj_text *text,
			    const struct obj_word *keyword, bool *known, struct error *err);

// After the last: bring the colours into 0 … 1, and find those that are equal. Colours that are whole numbers, up to 255,
// are taken as bytes. STATUS_MEMORY.
enum status obj_points_end(struct obj_points *points, struct import *import, struct error *err);

// Free the lists.
void obj_points_finish(struct obj_points *points);

#endif
