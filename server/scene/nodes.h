// Cameras and lights on nodes: the node's transform places them in world space. Any thread.
#ifndef CANDIL_SCENE_NODES_H
#define CANDIL_SCENE_NODES_H

#include "server/scene/blob.h"

// Set eye, forward and up of a camera. False, and the camera unchanged, if the transform leaves no direction, or if the
// position is beyond LIMIT_COORDINATE.
bool node_place_camera(const struct transform *world, struct blob_camera *camera);

// Set the direction of a light, if it has one, and its world position in metres. False, and both unchanged, in the same
// cases; a point light needs only the position.
bool node_place_light(const struct transform *world, struct punctual_light *light, double position[3]);

#endif
