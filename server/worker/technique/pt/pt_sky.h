// A picture of the surroundings in Vulkan memory: with the scene that it is, for all jobs that use it.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_SKY_H
#define CANDIL_WORKER_TECHNIQUE_PT_SKY_H

#include "server/worker/scenes/resident.h"

struct pt_sky {
	struct derived derived;
	struct device *device;
	struct buffer texels; // struct environment_texel
	struct buffer rows; // struct environment_row
};

// The picture's buffers, made now unless they are there. They stay while a job holds the scene. STATUS_MEMORY.
enum status pt_sky_get(struct resident_scene *picture, struct device *device, const struct pt_sky **sky, struct error *err);

#endif
