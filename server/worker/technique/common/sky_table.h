// By what an environment's directions are chosen, on OpenGL: kept with the picture's resident scene, for all jobs that use
// it. Its texels are sky_map.h's. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_SKY_TABLE_H
#define CANDIL_WORKER_TECHNIQUE_SKY_TABLE_H

#include "server/worker/gl/texels.h"
#include "server/worker/scenes/resident.h"

// The table of one picture, which its resident scene owns.
struct sky_table {
	struct derived derived;
	struct gl_texels rows; // struct environment_row
};

// The table of a picture, made unless it is there. It stays while a job holds the picture's scene. STATUS_MEMORY,
// STATUS_DEVICE.
enum status sky_table_get(struct resident_scene *picture, struct gl_device *device, const struct sky_table **sky,
			  struct error *err);

#endif
