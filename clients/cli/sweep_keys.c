#include "clients/cli/sweep_keys.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/sweep_cameras.h"

// Catmull and Rom 1974, uniform: the curve goes from b (t = 0) to c (t = 1) with the slopes of a to c and of b to d.
static double spline_number(double a, double b, double c, double d, double t)
{
	const double t2 = t * t, t3 = t2 * t;
	return 0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t2 + (3 * b - a - 3 * c + d) * t3);
}

static struct candil_vec3 spline_vec3(const struct candil_vec3 v[4], double t)
{
	return (struct candil_vec3){spline_number(v[0].x, v[1].x, v[2].x, v[3].x, t),
				    spline_number(v[0].y, v[1].y, v[2].y, v[3].y, t),
				    spline_number(v[0].z, v[1].z, v[2].z, v[3].z, t)};
}

// Key `i`, which may be one beyond either end. There the line through the last two keys is continued.
static struct candil_camera key_at(const struct candil_camera *keys, uint32_t count, int64_t i)
{
	if (i >= 0 && i < (int64_t)count)
		return keys[i];
	const struct candil_camera *a = &keys[i < 0 ? 0 : count - 1], *b = &keys[i < 0 ? 1 : count - 2];
	return (struct candil_camera){
	    .eye = {2 * a->eye.x - b->eye.x, 2 * a->eye.y - b->eye.y, 2 * a->eye.z - b->eye.z},
	    .target = {2 * a->target.x - b->target.x, 2 * a->target.y - b->target.y, 2 * a->target.z - b->target.z},
	    .up = {2 * a->up.x - b->up.x, 2 * a->up.y - b->up.y, 2 * a->up.z - b->up.z},
	    .vfov_degrees = 2 * a->vfov_degrees - b->vfov_degrees};
}

static struct candil_camera camera_between(const struct candil_camera *keys, uint32_t count, uint32_t key, double t)
{
	struct candil_vec3 eye[4], target[4], up[4];
	double angle[4];
	for (int k = 0; k < 4; k++) {
		const struct candil_camera c = key_at(keys, count, (int64_t)key + k - 1);
		eye[k] = c.eye;
		target[k] = c.target;
		up[k] = c.up;
		angle[k] = c.vfov_degrees;
	}
	const double vfov = spline_number(angle[0], angle[1], angle[2], angle[3], t);
	return (struct candil_camera){.eye = spline_vec3(eye, t),
				      .target = spline_vec3(target, t),
				      .up = spline_vec3(up, t),
				      .vfov_degrees = fmin(fmax(vfov, fmin(angle[1], angle[2])), fmax(angle[1], angle[2]))};
}

struct candil_camera *sweep_keys_spread(const struct candil_camera *keys, uint32_t count, uint32_t frames)
{
	struct candil_camera *out = calloc(frames, sizeof(*out));
	for (uint32_t i = 0; out && i < frames; i++) {
		const double at = frames > 1 ? (double)i * (count - 1) / (frames - 1) : 0;
		const uint32_t key = (uint32_t)floor(at);
		// A frame on a key is that key exactly, without what the spline would round.
		out[i] = key + 1 >= count || !(at > key) ? keys[key < count ? key : count - 1]
							 : camera_between(keys, count, key, at - key);
	}
	return out;
}

bool sweep_animation_length(const struct candil_scene_info *scene, const char *name, double *seconds)
{
	for (uint32_t i = 0; i < scene->animation_list_count; i++) {
		char number[16];
		snprintf(number, sizeof(number), "#%u", i);
		if (strcmp(scene->animations[i].name, name) == 0 || strcmp(number, name) == 0) {
			*seconds = scene->animations[i].duration_s;
			return true;
		}
	}
	return false;
}

uint32_t sweep_frames_of(double seconds, double fps)
{
	const double frames = floor(fmax(seconds, 0) * fps + 1e-6) + 1;
	return frames <= SWEEP_CAMERAS_MAX ? (uint32_t)frames : 0;
}
