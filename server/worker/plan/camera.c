#include "server/worker/plan/camera.h"

#include <math.h>
#include <string.h>

#include "server/base/angle.h"
#include "server/base/vec3.h"

// Make the image plane from the view direction and any vector `up` that is not along it.
static enum status aim(struct plan *p, const double up[3], double half_height, struct error *err)
{
	struct plan_camera *c = &p->camera;
	double right[3], straight_up[3];
	if (!vec3_normalize(c->forward))
		return error_set(err, STATUS_BAD_ARGUMENT, "the camera's eye and target are the same point: move one");
	vec3_cross(c->forward, up, right);
	if (!vec3_normalize(right))
		return error_set(err, STATUS_BAD_ARGUMENT, "the camera's up direction is along its view: choose another");
	vec3_cross(right, c->forward, straight_up);
	// A panorama has no image plane: unit vectors are enough.
	const double half_width = c->panorama ? 1 : half_height * p->width / p->height;
	for (int i = 0; i < 3; i++) {
		c->right[i] = right[i] * half_width;
		c->up[i] = straight_up[i] * half_height;
	}
	return STATUS_OK;
}

// Put the request's lens in the place of the camera's own. `half_height` is that of the camera's image plane; returns the
// one to use.
static double lens_half_height(const candil_Lens *lens, struct plan_camera *c, double half_height)
{
	c->lens_radius = lens->radius;
	c->focus = lens->focus;
	c->panorama = lens->projection == candil_Projection_PROJECTION_PANORAMA;
	if (lens->projection == candil_Projection_PROJECTION_CAMERA)
		return half_height;
	c->orthographic = !c->panorama;
	return c->orthographic ? lens->height / 2 : 1;
}

static enum status camera_of_scene(const struct blob_camera *from, const candil_Lens *lens, struct plan *p,
				   struct error *err)
{
	memcpy(p->camera.eye, from->eye, sizeof p->camera.eye);
	memcpy(p->camera.forward, from->forward, sizeof p->camera.forward);
	p->camera.orthographic = from->vfov_degrees == 0;
	double half = p->camera.orthographic ? from->half_height : tan(from->vfov_degrees * PI / 360);
	half = lens_half_height(lens, &p->camera, half);
	return aim(p, from->up, half, err);
}

enum status plan_camera(const candil_Render *r, const struct blob_view *scene, struct plan *p, struct error *err)
{
	const struct blob_camera *cameras = scene->sections[BLOB_CAMERAS];
	const uint32_t count = scene->counts[BLOB_CAMERAS];
	const candil_Camera *c = &r->camera;
	if (r->has_camera && c->name[0]) {
		for (uint32_t i = 0; i < count; i++)
			if (!strcmp(cameras[i].name, c->name))
				return camera_of_scene(&cameras[i], &r->lens, p, err);
		return error_set(err, STATUS_BAD_ARGUMENT, "the scene has no camera '%s': `candil describe` lists them",
				 c->name);
	}
	if (!r->has_camera || !c->has_eye) {
		if (count == 0)
			return error_set(err, STATUS_BAD_ARGUMENT, "the scene has no camera: give one with the request");
		return camera_of_scene(&cameras[0], &r->lens, p, err);
	}
	const double eye[3] = {c->eye.x, c->eye.y, c->eye.z};
	const double target[3] = {c->target.x, c->target.y, c->target.z};
	const double y_up[3] = {0, 1, 0};
	const double up[3] = {c->up.x, c->up.y, c->up.z};
	const bool needs_angle = r->lens.projection == candil_Projection_PROJECTION_CAMERA;
	if (needs_angle && !(c->vfov_degrees > 0 && c->vfov_degrees < 180))
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "the camera's vertical field of view must be between 0 and 180 degrees");
	for (int i = 0; i < 3; i++) {
		p->camera.eye[i] = eye[i];
		p->camera.forward[i] = target[i] - eye[i];
	}
	const double half = lens_half_height(&r->lens, &p->camera, tan(c->vfov_degrees * PI / 360));
	return aim(p, c->has_up ? up : y_up, half, err);
}
