// Where a scene's files are: from a path to the folder that a loader may look in and the file's name there.
#ifndef CANDIL_FRONT_SOURCE_H
#define CANDIL_FRONT_SOURCE_H

#include "server/base/error.h"

struct source {
	int folder; // O_PATH; -1: none
	char file[LIMIT_PATH + 1];
};

// A client's path (plain components, as request_load checked) beneath the folder `root`; < 0: the daemon has none. Symbolic
// links may not lead out of it. STATUS_SCENE_PATH, STATUS_SCENE_FILE.
enum status source_beneath(struct source *source, int root, const char *path, struct error *err);

// The daemon's own argument: any path.
enum status source_own(struct source *source, const char *path, struct error *err);

// A client's descriptor of the folder (taken over, on failure too) and a path in it.
enum status source_given(struct source *source, int folder, const char *path, struct error *err);

void source_close(struct source *source);

#endif
