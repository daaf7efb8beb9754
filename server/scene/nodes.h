// What stands on a node: cameras and lights, placed by the node's transform to world space. Any thread.
#ifndef CANDIL_SCENE_NODES_H
#define CANDIL_SCENE_NODES_H

#include "server/scene/blob.h"

// Eye, forward and up of a camera. False, and the camera left alone, where the transform leaves no direction, or the place
// is beyond LIMIT_COORDINATE.
bool node_place_camera(const struct transform *world, struct blob_camera *camera);

// Direction and world position of a light; a light that shines along a direction needs one. False as above.
bool node_place_light(const struct transform *world, struct punctual_light *light, double position[3]);

#endif
