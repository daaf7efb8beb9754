#include <stdlib.h>
#include <string.h>

#include "server/scene/animation.h"
#include "server/worker/scenes/edit.h"
#include "server/worker/scenes/edit_names.h"

// The parts of each node's transform that edits and animations set.
struct pose {
	struct transform_parts *parts;
	uint8_t *moved; // bits 1 << enum channel_path
};

static void move_node(const candil_NodeEdit *edit, struct transform_parts *parts, uint8_t *moved)
{
	if (edit->has_translation) {
		const double v[3] = {edit->translation.x, edit->translation.y, edit->translation.z};
		memcpy(parts->translation, v, sizeof v);
		*moved |= 1u << CHANNEL_TRANSLATION;
	}
	if (edit->has_rotation) {
		const double q[4] = {edit->rotation.x, edit->rotation.y, edit->rotation.z, edit->rotation.w};
		memcpy(parts->rotation, q, sizeof q);
		*moved |= 1u << CHANNEL_ROTATION;
	}
	if (edit->has_scale) {
		const double v[3] = {edit->scale.x, edit->scale.y, edit->scale.z};
		memcpy(parts->scale, v, sizeof v);
		*moved |= 1u << CHANNEL_SCALE;
	}
}

static enum status set_parts(const struct blob_view *view, const candil_Edits *edits, struct pose *pose, struct error *err)
{
	const struct name_list nodes = names_of(view, BLOB_SCENE_NODES, "node");
	const struct name_list animations = names_of(view, BLOB_ANIMATIONS, "animation");
	const struct scene_animation *animation = view->sections[BLOB_ANIMATIONS];
	uint32_t at;
	if (edits->animation[0]) {
		if (name_find(&animations, edits->animation, &at, err) != STATUS_OK)
			return err->code;
		animation_apply(view->blob, &animation[at], edits->time_s, pose->parts, pose->moved);
	}
	for (pb_size_t i = 0; i < edits->nodes_count; i++) {
		if (name_find(&nodes, edits->nodes[i].name, &at, err) != STATUS_OK)
			return err->code;
		move_node(&edits->nodes[i], &pose->parts[at], &pose->moved[at]);
	}
	return STATUS_OK;
}

// A node that is only translated keeps the rest of its matrix, which its parts may not reproduce exactly.
static struct transform local_of(const struct scene_node *node, const struct transform_parts *parts, uint8_t moved)
{
	struct transform local = node->local;
	if (moved & (1u << CHANNEL_ROTATION | 1u << CHANNEL_SCALE))
		return transform_of_parts(parts);
	if (moved)
		memcpy(local.c[3], parts->translation, sizeof local.c[3]);
	return local;
}

static enum status pose_place(struct edited *e, const struct pose *pose, struct transform *world, struct error *err)
{
	const struct scene_node *nodes = e->view.sections[BLOB_SCENE_NODES];
	for (uint32_t i = 0; i < e->view.counts[BLOB_SCENE_NODES]; i++) {
		const struct transform local = local_of(&nodes[i], &pose->parts[i], pose->moved[i]);
		world[i] = nodes[i].parent == NONE ? local : transform_compose(&world[nodes[i].parent], &local);
		if (!transform_is_finite(&world[i]))
			return error_set(err, STATUS_BAD_ARGUMENT,
					 "node '%s' cannot be moved there: it is too far or too large", nodes[i].name);
		if (transform_is_same(&world[i], &nodes[i].world))
			world[i] = nodes[i].world;
		else
			e->moves[e->move_count++] = (struct scene_move){i, nodes[i].first_triangle, nodes[i].triangle_count};
	}
	return STATUS_OK;
}

enum status edit_pose(struct edited *e, const candil_Edits *edits, struct transform *world, struct error *err)
{
	const struct scene_node *nodes = e->view.sections[BLOB_SCENE_NODES];
	const size_t count = e->view.counts[BLOB_SCENE_NODES];
	if (edits->nodes_count == 0 && !edits->animation[0]) {
		for (size_t i = 0; i < count; i++)
			world[i] = nodes[i].world;
		return STATUS_OK;
	}
	struct pose pose = {malloc((count + 1) * sizeof *pose.parts), calloc(count + 1, 1)};
	enum status status = STATUS_OK;
	e->moves = malloc((count + 1) * sizeof *e->moves);
	if (!pose.parts || !pose.moved || !e->moves) {
		status = error_set(err, STATUS_MEMORY, "no memory for %zu nodes", count);
		goto out;
	}
	for (size_t i = 0; i < count; i++)
		pose.parts[i] = nodes[i].parts;
	status = set_parts(&e->view, edits, &pose, err);
	if (status == STATUS_OK)
		status = pose_place(e, &pose, world, err);
out:
	free(pose.parts);
	free(pose.moved);
	return status;
}
