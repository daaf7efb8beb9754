// A camera for a scene that has none.
#ifndef CANDIL_CLI_VIEW_H
#define CANDIL_CLI_VIEW_H

#include "clients/libcandil/candil.h"

// Put the scene's bounds into the picture: from the front (+Z, glTF's front), the higher the flatter the scene is, from the
// side if it faces that way. Sets the request's camera; its width and height must be set.
void view_frame_bounds(const struct candil_scene_info *scene, struct candil_render_request *request);

#endif
