// Where a scene's files are: from a path to the folder that a loader may look in, and the file's name there. A source
// that was made is the caller's, to be closed with source_close or handed on; after a failure there is nothing to close.
//
// For the front's one thread (loop.h).
#ifndef CANDIL_FRONT_SOURCE_H
#define CANDIL_FRONT_SOURCE_H

#include "server/base/error.h"

struct source {
	int folder; // O_PATH; -1: none
	char file[LIMIT_PATH + 1];
};

// A client's path of plain components, as request_load has checked, beneath the folder `root`; negative: the daemon has
// none. Symbolic links may not lead out of it. Failures: STATUS_SCENE_PATH, STATUS_SCENE_FILE.
enum status source_beneath(struct source *source, int root, const char *path, struct error *err);

// A path from the daemon's own command line: any. Failures: STATUS_SCENE_PATH, STATUS_SCENE_FILE.
enum status source_own(struct source *source, const char *path, struct error *err);

// A client's descriptor of the folder, which is taken over, on failure too, and a path in it. Failure: STATUS_SCENE_PATH.
enum status source_given(struct source *source, int folder, const char *path, struct error *err);

void source_close(struct source *source);

#endif
