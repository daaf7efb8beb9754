// Scenes for C tests: run candil-loader on a file as candild does, and keep the blob.
#ifndef CANDIL_TESTS_LOAD_SCENE_H
#define CANDIL_TESTS_LOAD_SCENE_H

#include <stddef.h>

#include "server/base/error.h"
#include "server/scene/blob.h"

struct loaded_scene {
	int fd; // sealed memfd
	const struct blob_header *blob; // mapped
	size_t bytes;
};

// `loader` is the program's path. STATUS_OK, or the loader's own error; STATUS_LOADER_LOST if it died.
enum status load_scene(const char *loader, const char *file, struct loaded_scene *scene, struct error *err);
void loaded_scene_finish(struct loaded_scene *scene);

#endif
