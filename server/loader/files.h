// The loader's only access to files: regular files beneath the scene's own folder, whose size is checked before the first
// byte is read. Neither "..", an absolute path nor a link leads out of the folder. One thread.
#ifndef CANDIL_LOADER_FILES_H
#define CANDIL_LOADER_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

struct files {
	int dir; // descriptor of the scene's folder; the caller's
	uint64_t bytes_read; // bytes of all files so far, at most LIMIT_SCENE_SOURCE_BYTES
	uint64_t entries_read; // entries of folders so far, at most LIMIT_FOLDER_ENTRIES
};

struct file_bytes {
	uint8_t *data; // `size` bytes followed by one zero byte; freed by file_bytes_finish
	size_t size;
};

// Open the folder that contains the file `path`, which is relative to `dir`. *folder becomes a descriptor that the caller
// closes. *name points to the file's name within `path`. STATUS_SCENE_FILE, STATUS_SCENE_PATH.
enum status files_open_folder(int dir, const char *path, int *folder, const char **name, struct error *err);

// Read a whole file. `name` is relative to the folder, with slashes.
// STATUS_SCENE_FILE: it is missing, unreadable or not a regular file. STATUS_SCENE_PATH: it lies outside of the folder.
// STATUS_SCENE_LIMIT: too many bytes. STATUS_MEMORY.
enum status files_read(struct files *files, const char *name, struct file_bytes *out, struct error *err);

// Whether files_read would find a regular file there.
bool files_exists(const struct files *files, const char *name);

// Find the one file whose name differs from `name` by nothing but the case of ASCII letters, as files of systems do that do
// not tell them apart. Of several folders, or files, the one that has the very name counts. `found`, of strlen(name) + 1
// bytes, becomes the file's name. False: there is none, or more than one, or looking would take too long.
bool files_find_in_any_case(struct files *files, const char *name, char *found);

// Free the bytes.
void file_bytes_finish(struct file_bytes *bytes);

#endif
