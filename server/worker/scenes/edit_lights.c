#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/names.h"
#include "server/base/angle.h"
#include "server/scene/lights.h"
#include "server/scene/nodes.h"
#include "server/worker/scenes/edit.h"

enum status edit_cameras(struct edited *e, const struct transform *world, struct error *err)
{
	const struct scene_node *nodes = e->view.sections[BLOB_SCENE_NODES];
	struct blob_camera *cameras = NULL;
	for (uint32_t i = 0; i < e->move_count; i++) {
		const struct scene_node *node = &nodes[e->moves[i].node];
		if (node->camera == NONE)
			continue;
		if (!cameras)
			cameras = edit_own(e, BLOB_CAMERAS, 0);
		if (!cameras)
			return error_set(err, STATUS_MEMORY, "no memory for %u cameras", e->view.counts[BLOB_CAMERAS]);
		if (!node_place_camera(&world[e->moves[i].node], &cameras[node->camera]))
			return error_set(err, STATUS_BAD_ARGUMENT,
					 "camera '%s' would have no direction or be too far away on node '%s'",
					 cameras[node->camera].name, node->name);
	}
	return STATUS_OK;
}

static void set_position(const struct blob_view *view, const double position[3], struct punctual_light *light)
{
	for (int c = 0; c < 3; c++)
		light->position[c] = (float)(position[c] - view->blob->origin[c]);
}

// Move the lights of moved nodes. A light whose node has shrunk to nothing becomes dark.
static void move_lights(const struct edited *e, const struct transform *world, struct punctual_light *lights)
{
	const struct scene_node *nodes = e->view.sections[BLOB_SCENE_NODES];
	for (uint32_t i = 0; i < e->move_count; i++) {
		const uint32_t light = nodes[e->moves[i].node].light;
		double position[3];
		if (light == NONE)
			continue;
		if (node_place_light(&world[e->moves[i].node], &lights[light], position))
			set_position(&e->view, position, &lights[light]);
		else
			memset(lights[light].intensity, 0, sizeof lights[light].intensity);
	}
}

static struct punctual_light light_of(const struct blob_view *view, const candil_Light *from)
{
	struct punctual_light out = {.kind = (uint32_t)from->kind};
	const unsigned traits = light_kind_traits(out.kind);
	const double position[3] = {from->position.x, from->position.y, from->position.z};
	double direction[3] = {from->direction.x, from->direction.y, from->direction.z};
	out.intensity[0] = (float)from->intensity.x;
	out.intensity[1] = (float)from->intensity.y;
	out.intensity[2] = (float)from->intensity.z;
	if (traits & LIGHT_HAS_PLACE)
		set_position(view, position, &out);
	if (traits & LIGHT_HAS_DIRECTION && transform_normalize(direction))
		for (int c = 0; c < 3; c++)
			out.direction[c] = (float)direction[c];
	if (traits & LIGHT_HAS_DISC)
		out.spread = (float)angle_spread(from->angle_degrees * PI / 360);
	if (traits & LIGHT_HAS_PLACE)
		out.range = lights_range(from->range);
	if (traits & LIGHT_HAS_CONE) {
		out.inner = (float)angle_spread(from->inner_degrees * PI / 180);
		out.outer = (float)fmin(angle_spread(from->outer_degrees * PI / 180), 1);
	}
	return out;
}

enum status edit_lights(struct edited *e, const candil_Edits *edits, const struct transform *world, struct error *err)
{
	struct blob_view *view = &e->view;
	// A move changes the bounds, and with them the weight of a directional light.
	if (edits->lights_count == 0 && !(edits->replace_lights && view->counts[BLOB_LIGHTS] > 0) &&
	    !(e->move_count > 0 && view->counts[BLOB_LIGHTS] > 0))
		return STATUS_OK;
	struct punctual_light *lights = edit_own(e, BLOB_LIGHTS, edits->lights_count);
	if (!lights)
		return error_set(err, STATUS_MEMORY, "no memory for %u lights", view->counts[BLOB_LIGHTS]);
	move_lights(e, world, lights);
	uint32_t count = edits->replace_lights ? 0 : view->counts[BLOB_LIGHTS];
	for (pb_size_t i = 0; i < edits->lights_count; i++)
		lights[count++] = light_of(view, &edits->lights[i]);
	const double radius = lights_bounding_radius(view->bounds_min, view->bounds_max);
	enum status status = lights_make_table(lights, &count, radius, NULL, &view->light_power, err);
	view->counts[BLOB_LIGHTS] = count;
	return status;
}

enum status edit_emitters(struct edited *e, struct error *err)
{
	struct blob_view *view = &e->view;
	struct emitter *emitters;
	uint32_t count;
	enum status status = lights_collect_emitters(view->sections[BLOB_MATERIALS], view->sections[BLOB_VERTICES],
						     view->sections[BLOB_TRIANGLES], view->counts[BLOB_TRIANGLES], &emitters,
						     &count, &view->emitter_power, err);
	if (status != STATUS_OK)
		return status;
	free(e->own[BLOB_EMITTERS]);
	e->own[BLOB_EMITTERS] = emitters;
	view->sections[BLOB_EMITTERS] = emitters;
	view->counts[BLOB_EMITTERS] = count;
	return STATUS_OK;
}
