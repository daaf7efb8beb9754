// The only way for the loader to a file: beneath the scene's own folder, regular, and of a size that was checked before the
// first byte is read. Neither "..", an absolute path nor a link leads out of the folder.
#ifndef CANDIL_LOADER_FILES_H
#define CANDIL_LOADER_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

struct files {
	int dir; // the scene's folder; the caller's
	uint64_t bytes_read; // of all files so far, ≤ LIMIT_SCENE_SOURCE_BYTES
};

struct file_bytes {
	uint8_t *data; // `size` bytes and one zero behind them; end with file_bytes_finish
	size_t size;
};

// Open the folder of the file `path` beneath `dir` for side files to be looked up in: *folder is the caller's to close.
// *name points to the file's name within `path`. STATUS_SCENE_FILE, STATUS_SCENE_PATH.
enum status files_open_folder(int dir, const char *path, int *folder, const char **name, struct error *err);

// Read a whole file. `name` is relative to the folder, with slashes.
// STATUS_SCENE_FILE: it is not there, unreadable or not a regular file. STATUS_SCENE_PATH: it lies outside of the folder.
// STATUS_SCENE_LIMIT: too many bytes. STATUS_MEMORY.
enum status files_read(struct files *files, const char *name, struct file_bytes *out, struct error *err);

// Whether files_read would find a regular file there.
bool files_exists(const struct files *files, const char *name);

void file_bytes_finish(struct file_bytes *bytes);

#endif
