// Cameras for a scene that has none.
#ifndef CANDIL_CLI_VIEW_H
#define CANDIL_CLI_VIEW_H

#include "clients/libcandil/candil.h"

// Set the request's camera so that the scene's bounds are in the picture. The camera looks from the front (+Z, which is
// glTF's front), from above if the scene is flat, from the side if it is thin along X. The request's width and height must
// be set.
void view_frame_bounds(const struct candil_scene_info *scene, struct candil_render_request *request);

// Make camera `index` of `count` on a circle about the centre of the scene's bounds. All look at the centre. The first is in
// front (+Z), the others follow counter-clockwise seen from above. `elevation`: degrees above the horizon, between -90
// and 90. `radius`: metres from the centre; 0: so far that the sphere about the bounds fits into the picture, whose width
// and height are the request's.
void view_orbit(const struct candil_scene_info *scene, const struct candil_render_request *request, uint32_t index,
		uint32_t count, double elevation, double radius, struct candil_camera *camera);

#endif
