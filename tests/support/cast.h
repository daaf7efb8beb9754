// Rays from a list through the device's traversal, and through Embree's, for tests and benchmarks.
#ifndef CANDIL_TESTS_CAST_H
#define CANDIL_TESTS_CAST_H

#include <embree3/rtcore.h>

#include "server/worker/scenes/resident.h"
#include "server/worker/vk/pipeline.h"
#include "shaders/shared/cast.h"

struct cast {
	struct device *device;
	struct pipeline *pipeline;
	struct binding_set bindings;
	struct buffer rays, hits;
	uint32_t count;
};

// Bring rays (and what of the scene they need) to the device. `packet`: walk by subgroups, else a ray a lane.
enum status cast_init(struct cast *cast, struct device *device, struct resident_scene *scene, const struct cast_ray *rays,
		      uint32_t count, bool packet, struct error *err);
void cast_finish(struct cast *cast);

// Trace them all and wait. `any`: whether there is a hit at all, in cast_hit.id (NONE: no).
enum status cast_run(struct cast *cast, bool any, struct error *err);
enum status cast_read(const struct cast *cast, struct cast_hit *hits, struct error *err);

// The same triangles in an Embree scene, RTC_SCENE_FLAG_ROBUST, primitives numbered by triangle id. Release it.
RTCScene cast_judge(RTCDevice device, const struct blob_header *blob);

// What a ray from there on, of any length, hits first.
struct RTCRayHit cast_judge_hit(RTCScene scene, const struct cast_ray *ray);

#endif
