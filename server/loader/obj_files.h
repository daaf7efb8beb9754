// assimp's access to files: the bytes of the scene file, which are already read, and MTL files in the scene's folder.
// Nothing else can be reached. Every MTL that is read is also scanned for what assimp does not preserve. One thread.
#ifndef CANDIL_LOADER_OBJ_FILES_H
#define CANDIL_LOADER_OBJ_FILES_H

#include <assimp/cfileio.h>

#include "server/loader/mtl_notes.h"

struct obj_files {
	struct aiFileIO io; // for assimp; its UserData is this struct
	struct import *import;
	const char *name; // name of the scene file
	const struct file_bytes *bytes; // content of the scene file; the caller's
	struct mtl_notes notes;
	bool library_missing;
	struct error failure; // limit or memory failure while reading an MTL; else OK
};

// Set up the access. The struct must not move until obj_files_finish. `name`, `bytes` and `import` must outlive it.
void obj_files_init(struct obj_files *files, struct import *import, const char *name, const struct file_bytes *bytes);
// Free the notes.
void obj_files_finish(struct obj_files *files);

#endif
