#include "server/worker/technique/pt_light_tree.h"

#include <stdlib.h>

#include "server/base/clock.h"
#include "server/scene/light_tree.h"
#include "server/worker/vk/pipeline.h"

// From so many emissive triangles on the tree is worth its steps: tests/bench/RESULTS.md.
#define TREE_FROM 32u

struct tree {
	struct derived derived;
	struct device *device;
	struct pt_light_tree buffers;
};

static const char kind; // its address is the tree's name among the derived

bool pt_light_tree_wanted(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan)
{
	const uint32_t count = scene_count(scene, BLOB_EMITTERS);
	if (!plan_has(plan, candil_Effect_EFFECT_EMITTERS) || plan->lamps == LAMPS_BY_CHANCE)
		return false;
	if (count == 0 || count > LIGHT_TREE_EMITTERS_MAX || plan->light_tree == LIGHT_TREE_OFF)
		return false;
	// Shaders read its nodes as texels.
	if (pt_light_tree_bytes(scene) / PIPELINE_TEXEL_BYTES > devices->vk->limits.maxTexelBufferElements)
		return false;
	return plan->light_tree == LIGHT_TREE_ON || count >= TREE_FROM;
}

uint64_t pt_light_tree_bytes(const struct resident_scene *scene)
{
	const uint32_t count = scene_count(scene, BLOB_EMITTERS);
	return (uint64_t)light_tree_nodes(count) * sizeof(struct light_node) + (uint64_t)count * sizeof(uint32_t);
}

static void destroy(struct derived *derived)
{
	struct tree *t = (struct tree *)derived;
	buffer_finish(&t->buffers.nodes, t->device);
	buffer_finish(&t->buffers.trails, t->device);
	free(t);
}

static uint64_t idle_bytes(const struct derived *derived)
{
	const struct tree *t = (const struct tree *)derived;
	return t->buffers.nodes.allocated + t->buffers.trails.allocated;
}

static enum status make(struct tree *t, const struct resident_scene *scene, struct error *err)
{
	const uint32_t count = scene_count(scene, BLOB_EMITTERS);
	const uint64_t node_bytes = (uint64_t)light_tree_nodes(count) * sizeof(struct light_node);
	struct light_node *nodes = malloc(node_bytes);
	uint32_t *trails = malloc(count * sizeof *trails);
	enum status s;
	if (!nodes || !trails)
		s = error_set(err, STATUS_MEMORY, "no memory for a tree of %u lamps", count);
	else
		s = light_tree_build(scene_section(scene, BLOB_MATERIALS), scene_section(scene, BLOB_VERTICES),
				     scene_section(scene, BLOB_TRIANGLES), scene_section(scene, BLOB_EMITTERS), count, nodes,
				     trails, err);
	if (s == STATUS_OK)
		s = buffer_init_with(&t->buffers.nodes, t->device, nodes, node_bytes, err);
	if (s == STATUS_OK)
		s = buffer_init_with(&t->buffers.trails, t->device, trails, count * sizeof *trails, err);
	free(nodes);
	free(trails);
	return s;
}

enum status pt_light_tree_get(struct device *device, struct resident_scene *scene, const struct pt_light_tree **out,
			      uint64_t *us, struct error *err)
{
	const uint64_t start = clock_us();
	struct tree *t = (struct tree *)resident_derived(scene, &kind);
	enum status s = STATUS_OK;
	if (!t) {
		t = calloc(1, sizeof *t);
		if (!t)
			return error_set(err, STATUS_MEMORY, "out of memory");
		t->derived = (struct derived){.kind = &kind, .destroy = destroy, .bytes = idle_bytes};
		t->device = device;
		s = make(t, scene, err);
		if (s == STATUS_OK)
			resident_derive(scene, &t->derived);
		else
			destroy(&t->derived);
		*us += clock_us() - start;
	}
	if (s == STATUS_OK)
		*out = &t->buffers;
	return s;
}
