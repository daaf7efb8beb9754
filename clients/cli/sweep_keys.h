// The frames of a sweep between its keys, and the times of its animation.
#ifndef CANDIL_CLI_SWEEP_KEYS_H
#define CANDIL_CLI_SWEEP_KEYS_H

#include "clients/cli/cli.h"

#define SWEEP_FPS_DEFAULT 24.0

// Spread `frames` cameras, at least one, over `count` keys: the first key is the first frame, the last key the last, and
// between them eye, target, up and angle run through the keys on a uniform Catmull-Rom spline; the angle is kept within
// those of its two neighbours. The result is the caller's, to be freed; NULL: no memory.
struct candil_camera *sweep_keys_spread(const struct candil_camera *keys, uint32_t count, uint32_t frames);

// The length in seconds of an animation, which is named by its name or by '#' and its number. false: the scene's list does
// not have it.
bool sweep_animation_length(const struct candil_scene_info *scene, const char *name, double *seconds);

// How many frames an animation of that many seconds has, both ends included; 0: more than SWEEP_CAMERAS_MAX.
uint32_t sweep_frames_of(double seconds, double fps);

#endif
