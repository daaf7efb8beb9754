#include "server/scene/blob_check_nodes.h"

#include <math.h>
#include <string.h>

static enum status bad(struct error *err, const char *what)
{
	return error_set(err, STATUS_SCENE_INVALID, "the scene blob is damaged: %s; load the scene again", what);
}

static bool parts_are_sane(const struct transform_parts *p)
{
	double square = 0;
	for (int i = 0; i < 4; i++)
		square += p->rotation[i] * p->rotation[i];
	for (int i = 0; i < 3; i++)
		if (!isfinite(p->translation[i]) || !isfinite(p->scale[i]))
			return false;
	return fabs(square - 1) < 1e-6;
}

static bool is_index(uint32_t index, uint32_t count)
{
	return index == NONE || index < count;
}

static enum status check_node(const struct blob_header *h, uint32_t i, struct error *err)
{
	const struct scene_node *nodes = blob_section(h, BLOB_SCENE_NODES), *n = &nodes[i];
	const uint32_t triangles = blob_count(h, BLOB_TRIANGLES);
	if (!memchr(n->name, 0, sizeof n->name))
		return bad(err, "a node's name does not end");
	if (n->parent != NONE && n->parent >= i)
		return bad(err, "a node comes before its parent");
	if (n->first_triangle > triangles || n->triangle_count > triangles - n->first_triangle)
		return bad(err, "a node has triangles that are not there");
	if (!is_index(n->light, blob_count(h, BLOB_LIGHTS)) || !is_index(n->camera, blob_count(h, BLOB_CAMERAS)))
		return bad(err, "a node has a light or a camera that is not there");
	if (!transform_is_finite(&n->local) || !transform_is_finite(&n->world) || !parts_are_sane(&n->parts))
		return bad(err, "a node's transform is out of range");
	const struct transform world = n->parent == NONE ? n->local : transform_compose(&nodes[n->parent].world, &n->local);
	return transform_is_same(&world, &n->world) ? STATUS_OK : bad(err, "a node's transform is not that of its parents");
}

static enum status check_channel(const struct blob_header *h, const struct scene_channel *c, struct error *err)
{
	const float *curves = blob_section(h, BLOB_CURVES);
	const uint64_t room = blob_count(h, BLOB_CURVES);
	if (c->node >= blob_count(h, BLOB_SCENE_NODES) || c->path > CHANNEL_SCALE || c->curve > CURVE_CUBIC || c->keys == 0)
		return bad(err, "an animation's channel is none");
	const uint64_t width = c->path == CHANNEL_ROTATION ? 4 : 3, values = c->curve == CURVE_CUBIC ? 3 : 1;
	const uint64_t count = c->keys * (1 + values * width); // below 2^36
	if (c->first > room || count > room - c->first)
		return bad(err, "an animation's curve ends behind the curves");
	for (uint64_t i = 0; i < count; i++)
		if (!isfinite(curves[c->first + i]))
			return bad(err, "an animation's curve is not finite");
	for (uint32_t i = 1; i < c->keys; i++)
		if (!(curves[c->first + i - 1] < curves[c->first + i]))
			return bad(err, "an animation's times do not ascend");
	return STATUS_OK;
}

static enum status check_animation(const struct blob_header *h, const struct scene_animation *a, struct error *err)
{
	const uint32_t channels = blob_count(h, BLOB_CHANNELS);
	if (!memchr(a->name, 0, sizeof a->name))
		return bad(err, "an animation's name does not end");
	if (a->first_channel > channels || a->channel_count > channels - a->first_channel)
		return bad(err, "an animation has channels that are not there");
	return isfinite(a->duration_s) ? STATUS_OK : bad(err, "an animation's length is not finite");
}

enum status blob_check_nodes(const struct blob_header *h, struct error *err)
{
	const struct scene_channel *channels = blob_section(h, BLOB_CHANNELS);
	const struct scene_animation *animations = blob_section(h, BLOB_ANIMATIONS);
	enum status status = STATUS_OK;
	for (uint32_t i = 0; i < blob_count(h, BLOB_SCENE_NODES) && status == STATUS_OK; i++)
		status = check_node(h, i, err);
	for (uint32_t i = 0; i < blob_count(h, BLOB_CHANNELS) && status == STATUS_OK; i++)
		status = check_channel(h, &channels[i], err);
	for (uint32_t i = 0; i < blob_count(h, BLOB_ANIMATIONS) && status == STATUS_OK; i++)
		status = check_animation(h, &animations[i], err);
	return status;
}
