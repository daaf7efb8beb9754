#include "server/scene/nodes.h"

#include <math.h>
#include <string.h>

#include "protocol/limits.h"

static bool is_place(const double v[3])
{
	for (int i = 0; i < 3; i++)
		if (!(fabs(v[i]) <= LIMIT_COORDINATE)) // false for NaN too
			return false;
	return true;
}

bool node_place_camera(const struct transform *world, struct blob_camera *camera)
{
	double eye[3], forward[3], up[3];
	for (int i = 0; i < 3; i++) {
		eye[i] = world->c[3][i];
		forward[i] = -world->c[2][i];
		up[i] = world->c[1][i];
	}
	if (!is_place(eye) || !is_place(forward) || !is_place(up) || !transform_normalize(forward) ||
	    !transform_normalize(up))
		return false;
	double along = 0, left = 0;
	for (int i = 0; i < 3; i++)
		along += forward[i] * up[i];
	for (int i = 0; i < 3; i++) {
		up[i] -= along * forward[i];
		left += up[i] * up[i];
	}
	if (!(left > 1e-12) || !transform_normalize(up))
		return false;
	memcpy(camera->eye, eye, sizeof eye);
	memcpy(camera->forward, forward, sizeof forward);
	memcpy(camera->up, up, sizeof up);
	return true;
}

bool node_place_light(const struct transform *world, struct punctual_light *light, double position[3])
{
	double forward[3];
	for (int i = 0; i < 3; i++)
		forward[i] = -world->c[2][i];
	if (!is_place(world->c[3]))
		return false;
	if (light->kind != LIGHT_POINT && !transform_normalize(forward))
		return false;
	memcpy(position, world->c[3], 3 * sizeof *position);
	for (int i = 0; i < 3 && light->kind != LIGHT_POINT; i++)
		light->direction[i] = (float)forward[i];
	return true;
}
