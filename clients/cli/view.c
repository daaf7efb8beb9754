#include "clients/cli/view.h"

#include <math.h>

static const double pi = 3.14159265358979323846;
static const double vfov_degrees = 40.0;

void view_frame_bounds(const struct candil_scene_info *scene, struct candil_render_request *request)
{
	const struct candil_vec3 *low = &scene->bounds_min, *high = &scene->bounds_max;
	double w = high->x - low->x, h = high->y - low->y, d = high->z - low->z;
	double radius = 0.5 * sqrt(w * w + h * h + d * d);
	struct candil_vec3 centre = {low->x + 0.5 * w, low->y + 0.5 * h, low->z + 0.5 * d};
	if (!isfinite(radius) || radius <= 0.0) {
		radius = 1.0;
		if (!isfinite(centre.x) || !isfinite(centre.y) || !isfinite(centre.z))
			centre = (struct candil_vec3){0, 0, 0};
		w = h = d = 1.0;
	}
	// A floor seen from its own height would be a line: up to 35 degrees above it. A wall along Z: from its side.
	double elevation = 35.0 * (1.0 - fmin(1.0, 2.0 * h / fmax(w, d))) * pi / 180.0;
	double azimuth = w < 0.1 * d ? 60.0 * pi / 180.0 : 0.0;
	double half_v = 0.5 * vfov_degrees * pi / 180.0;
	double half_h = atan(tan(half_v) * (double)request->width / (double)request->height);
	double distance = 1.02 * radius / sin(fmin(half_v, half_h));
	request->eye.x = centre.x + distance * cos(elevation) * sin(azimuth);
	request->eye.y = centre.y + distance * sin(elevation);
	request->eye.z = centre.z + distance * cos(elevation) * cos(azimuth);
	request->target = centre;
	request->up = (struct candil_vec3){0, 1, 0};
	request->vfov_degrees = vfov_degrees;
	request->has_camera = true;
}
