// The environment in Vulkan memory: buffers kept with the picture's resident scene, for all jobs that use it. Device's
// thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_SKY_TEXELS_H
#define CANDIL_WORKER_TECHNIQUE_SKY_TEXELS_H

#include "server/worker/scenes/resident.h"

// The buffers of one picture, which its resident scene owns.
struct sky_texels {
	struct derived derived;
	struct device *device;
	struct buffer texels; // struct environment_texel
	struct buffer rows; // struct environment_row
};

// The buffers of a picture, made unless they are there. They stay while a job holds the picture's scene. STATUS_MEMORY,
// STATUS_DEVICE.
enum status sky_texels_get(struct resident_scene *picture, struct device *device, const struct sky_texels **sky,
			   struct error *err);

#endif
