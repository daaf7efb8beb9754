// The groups and objects of an OBJ file, which become nodes. Faces of one name make one node, wherever they stand in the
// file. One thread.
#ifndef CANDIL_LOADER_OBJ_GROUPS_H
#define CANDIL_LOADER_OBJ_GROUPS_H

#include "server/loader/import.h"
#include "server/loader/key_table.h"

struct obj_groups {
	struct key_table names;
	char **texts; // the names of the groups
	size_t text_count, text_room;
	struct obj_run *runs;
	size_t run_count, run_room;
	char *next; // the name of the faces to come; NULL: that of the last run
};

void obj_groups_init(struct obj_groups *groups);
void obj_groups_finish(struct obj_groups *groups);

// Name the group of the faces to come. The name becomes the groups'.
void obj_groups_name(struct obj_groups *groups, char *name);

// The number of the group that the next triangles of the import belong to. STATUS_SCENE_LIMIT, STATUS_MEMORY.
enum status obj_groups_current(struct obj_groups *groups, const struct import *import, uint32_t *number, struct error *err);

// After the last triangle: order the triangles by group and add the nodes. STATUS_SCENE_LIMIT, STATUS_MEMORY.
enum status obj_groups_end(struct obj_groups *groups, struct import *import, struct error *err);

#endif
