// One scene file, from its name to a sealed blob.
#ifndef CANDIL_LOADER_LOAD_H
#define CANDIL_LOADER_LOAD_H

#include <stdbool.h>

#include "candil.pb.h"
#include "server/base/error.h"

struct load_options {
	const char *file; // in the folder
	int dir; // the scene's folder
	bool z_up; // OBJ only
	double metres_per_unit; // OBJ only, above 0
};

// *fd is the blob's sealed memfd, the caller's, or -1 on failure. *info holds what `describe` shows, without name and time.
enum status load_scene(const struct load_options *options, candil_SceneInfo *info, int *fd, struct error *err);

#endif
