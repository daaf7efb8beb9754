// Loads one scene file, from its name to a sealed blob. One thread.
#ifndef CANDIL_LOADER_LOAD_H
#define CANDIL_LOADER_LOAD_H

#include <stdbool.h>

#include "candil.pb.h"
#include "server/base/error.h"
#include "server/base/remarks.h"
#include "server/loader/image_read.h"

struct load_options {
	const char *file; // relative to `dir`
	int dir; // descriptor of a folder, the caller's
	bool z_up; // OBJ only
	double metres_per_unit; // OBJ only, above 0
	const struct image_decoder *decoder; // NULL: none; a scene with images then fails, and sets wants_decoder
	bool wants_decoder;
};

// Load a scene. *fd becomes the blob's sealed memfd, which the caller owns, or -1 on failure. *info receives what
// `describe` shows, except name and time, and *remarks what of it leaves pictures as they are. Fails with any
// STATUS_SCENE_…, STATUS_MEMORY and STATUS_INTERNAL.
enum status load_scene(struct load_options *options, candil_SceneInfo *info, struct scene_remarks *remarks, int *fd,
		       struct error *err);

#endif
