// assimp's window to the file system: the scene file's bytes, already read, and MTL files through the opener. Nothing else
// can be reached, and every MTL that was read is scanned for what assimp will not tell.
#ifndef CANDIL_LOADER_OBJ_FILES_H
#define CANDIL_LOADER_OBJ_FILES_H

#include <assimp/cfileio.h>

#include "server/loader/mtl_notes.h"

struct obj_files {
	struct aiFileIO io; // what assimp gets; its UserData is this struct
	struct import *import;
	const char *name; // the scene file …
	const struct file_bytes *bytes; // … and its content
	struct mtl_notes notes;
	bool library_missing;
	struct error failure; // of an MTL: limit or memory; else OK
};

// The struct must not move between this and obj_files_finish.
void obj_files_init(struct obj_files *files, struct import *import, const char *name, const struct file_bytes *bytes);
void obj_files_finish(struct obj_files *files);

#endif
