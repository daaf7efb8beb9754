#include "clients/cli/view.h"

#include <math.h>

#include "clients/cli/angles.h"

static const double vfov_degrees = 40.0;
static const double margin = 1.04;

static double view_dot(const struct candil_vec3 *a, const struct candil_vec3 *b)
{
	return a->x * b->x + a->y * b->y + a->z * b->z;
}

// The distance from the centre in the direction `back` from which all eight corners of a box are in view.
static double fitting_distance(const struct candil_vec3 *half, const struct candil_vec3 *right, const struct candil_vec3 *up,
			       const struct candil_vec3 *back, double tan_h, double tan_v)
{
	double distance = 0.0;
	for (int i = 0; i < 8; i++) {
		struct candil_vec3 corner = {i & 1 ? half->x : -half->x, i & 2 ? half->y : -half->y,
					     i & 4 ? half->z : -half->z};
		double sideways = fmax(fabs(view_dot(&corner, right)) / tan_h, fabs(view_dot(&corner, up)) / tan_v);
		distance = fmax(distance, view_dot(&corner, back) + margin * sideways);
	}
	return distance;
}

// The centre and half the sizes of the bounds. Without bounds: those of a cube about the origin.
static void find_box(const struct candil_scene_info *scene, struct candil_vec3 *centre, struct candil_vec3 *half)
{
	const struct candil_vec3 *low = &scene->bounds_min, *high = &scene->bounds_max;
	*half = (struct candil_vec3){0.5 * (high->x - low->x), 0.5 * (high->y - low->y), 0.5 * (high->z - low->z)};
	*centre = (struct candil_vec3){low->x + half->x, low->y + half->y, low->z + half->z};
	double size = half->x + half->y + half->z;
	if (!isfinite(size) || size <= 0.0 || !isfinite(centre->x + centre->y + centre->z)) {
		*half = (struct candil_vec3){1, 1, 1};
		*centre = (struct candil_vec3){0, 0, 0};
	}
}

void view_frame_bounds(const struct candil_scene_info *scene, struct candil_render_request *request)
{
	struct candil_vec3 centre, half;
	find_box(scene, &centre, &half);
	// A floor seen from its own height would be a line, so a flat scene is seen from up to 35 degrees above. A wall that
	// runs along Z would be one too, so it is seen from its side.
	double elevation = angles_radians(35.0 * (1.0 - fmin(1.0, 2.0 * half.y / fmax(half.x, half.z))));
	double azimuth = half.x < 0.1 * half.z ? angles_radians(60.0) : 0.0;
	const struct candil_vec3 back = {cos(elevation) * sin(azimuth), sin(elevation), cos(elevation) * cos(azimuth)};
	const struct candil_vec3 right = {cos(azimuth), 0, -sin(azimuth)};
	const struct candil_vec3 up = {-sin(elevation) * sin(azimuth), cos(elevation), -sin(elevation) * cos(azimuth)};
	double tan_v = tan(angles_radians(0.5 * vfov_degrees));
	double tan_h = tan_v * (double)request->width / (double)request->height;
	double distance = fitting_distance(&half, &right, &up, &back, tan_h, tan_v);
	request->eye.x = centre.x + distance * back.x;
	request->eye.y = centre.y + distance * back.y;
	request->eye.z = centre.z + distance * back.z;
	request->target = centre;
	request->up = (struct candil_vec3){0, 1, 0};
	request->vfov_degrees = vfov_degrees;
	request->has_camera = true;
}

void view_orbit(const struct candil_scene_info *scene, const struct candil_render_request *request, uint32_t index,
		uint32_t count, double elevation, double radius, struct candil_camera *camera)
{
	struct candil_vec3 centre, half;
	find_box(scene, &centre, &half);
	double tan_v = tan(angles_radians(0.5 * vfov_degrees));
	double tan_h = tan_v * (double)request->width / (double)request->height;
	double narrow = atan(fmin(tan_v, tan_h));
	double distance = radius > 0.0 ? radius : margin * sqrt(view_dot(&half, &half)) / sin(narrow);
	double azimuth = 2.0 * ANGLES_PI * (double)index / (double)count;
	double height = angles_radians(elevation);
	*camera = (struct candil_camera){.target = centre, .up = {0, 1, 0}, .vfov_degrees = vfov_degrees};
	camera->eye.x = centre.x + distance * cos(height) * sin(azimuth);
	camera->eye.y = centre.y + distance * sin(height);
	camera->eye.z = centre.z + distance * cos(height) * cos(azimuth);
}
