// Animations of a checked blob: the transforms of its nodes at a given time. Any thread; cannot fail.
#ifndef CANDIL_SCENE_ANIMATION_H
#define CANDIL_SCENE_ANIMATION_H

#include "server/scene/blob.h"

// Write the state of `animation` at `time_s` (seconds) into `parts` of the nodes that it moves, and mark what it moved:
// moved[node] gets the bits 1 << enum channel_path. Before the first key and after the last, a curve keeps that key's
// value. The caller's `parts` and `moved` have an element for each node.
void animation_apply(const struct blob_header *blob, const struct scene_animation *animation, double time_s,
		     struct transform_parts *parts, uint8_t *moved);

// The value of one channel at a time in seconds: three components, or the four of a unit quaternion (glTF 2.0, appendix C:
// linear rotations are spherical, along the shorter arc; cubic ones are normalised afterwards).
void animation_sample(const struct scene_channel *channel, const float *curves, double time_s, double out[4]);

#endif
