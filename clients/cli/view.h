// Cameras for a scene that has none.
#ifndef CANDIL_CLI_VIEW_H
#define CANDIL_CLI_VIEW_H

#include "clients/libcandil/candil.h"

// Put the scene's bounds into the picture: from the front (+Z, glTF's front), the higher the flatter the scene is, from the
// side if it faces that way. Sets the request's camera; its width and height must be set.
void view_frame_bounds(const struct candil_scene_info *scene, struct candil_render_request *request);

// Camera `index` of `count` on a circle about the centre of the scene's bounds, which it looks at: the first in front (+Z),
// then counter-clockwise seen from above. `elevation`: degrees above the horizon, between -90 and 90. `radius`: metres from
// the centre; 0: so far that the sphere about the bounds fits the picture, whose width and height the request says.
void view_orbit(const struct candil_scene_info *scene, const struct candil_render_request *request, uint32_t index,
		uint32_t count, double elevation, double radius, struct candil_camera *camera);

#endif
