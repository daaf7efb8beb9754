// Animations of a checked blob: where its nodes are at a time. Any thread.
#ifndef CANDIL_SCENE_ANIMATION_H
#define CANDIL_SCENE_ANIMATION_H

#include "server/scene/blob.h"

// Put what `animation` says of time `time_s` into the parts of the nodes that it moves, and mark what it moved: moved[node]
// gets bits 1 << enum channel_path. Before the first key and after the last the curve stays at that key. `parts` and `moved`
// have an element a node.
void animation_apply(const struct blob_header *blob, const struct scene_animation *animation, double time_s,
		     struct transform_parts *parts, uint8_t *moved);

// One channel's value at a time: three components, or four of a unit quaternion (glTF 2.0, appendix C: linear rotations are
// spherical, along the shorter way; cubic ones are made unit afterwards).
void animation_sample(const struct scene_channel *channel, const float *curves, double time_s, double out[4]);

#endif
