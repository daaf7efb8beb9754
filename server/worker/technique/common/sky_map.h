// A picture of the surroundings on the OpenGL device: with the scene that it is, for all jobs that use it. Beside its texels
// it has what cones see of it, as means over their apertures, so that one lookup a cone is enough however wide it is.
#ifndef CANDIL_WORKER_TECHNIQUE_SKY_MAP_H
#define CANDIL_WORKER_TECHNIQUE_SKY_MAP_H

#include "server/worker/gl/texture.h"
#include "server/worker/scenes/resident.h"
#include "shaders/shared/sky.h"

struct sky_map {
	struct derived derived;
	struct gl_device *device;
	struct gl_texture picture; // SKY_PICTURE_UNIT
	struct gl_texture cones; // SKY_CONES_UNIT
	float most; // largest component of what cones see
};

// The picture's textures, made now unless they are there. They stay while a job holds the scene. STATUS_MEMORY.
enum status sky_map_get(struct resident_scene *picture, struct gl_device *device, const struct sky_map **map,
			struct error *err);

void sky_map_bind(const struct sky_map *map);

#endif
