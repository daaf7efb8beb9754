// The environment on the OpenGL device: textures kept with the picture's resident scene, for all jobs that use it. Beside
// its texels there is the mean radiance that cones see, by direction and aperture, so that one lookup a cone is enough
// however wide the cone is. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_SKY_MAP_H
#define CANDIL_WORKER_TECHNIQUE_SKY_MAP_H

#include "server/worker/gl/texture.h"
#include "server/worker/scenes/resident.h"
#include "shaders/shared/sky.h"

// The textures of one picture, which its resident scene owns.
struct sky_map {
	struct derived derived;
	struct gl_device *device;
	struct gl_texture picture; // its texels, at SKY_PICTURE_UNIT
	struct gl_texture cones; // means over cones, at SKY_CONES_UNIT
	float most; // largest component of those means, in the file's unit
};

// The textures of a picture, made unless they are there. They stay while a job holds the picture's scene. STATUS_MEMORY,
// STATUS_DEVICE.
enum status sky_map_get(struct resident_scene *picture, struct gl_device *device, const struct sky_map **map,
			struct error *err);

// Bind both textures to their units.
void sky_map_bind(const struct sky_map *map);

#endif
