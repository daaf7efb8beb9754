#include "server/worker/technique/pt/pt_light_tree.h"

#include <stdlib.h>

#include "server/base/clock.h"
#include "server/scene/light_tree.h"
#include "server/worker/technique/pt/pt_options.h"
#include "server/worker/vk/pipeline.h"

// From so many emissive triangles or lights on the tree is worth its time: tests/bench/RESULTS.md.
#define TREE_FROM_EMITTERS 32u
#define TREE_FROM_LIGHTS 2u

struct tree {
	struct derived derived;
	struct device *device;
	struct pt_light_tree buffers;
};

// A kind of struct derived for each choice of what is in the tree.
static const char kinds[8];

static struct light_tree_lamps lamps_of(const struct resident_scene *scene, const struct plan *plan)
{
	const bool emitters = plan_has(plan, candil_Effect_EFFECT_EMITTERS);
	const bool lights = plan_has(plan, candil_Effect_EFFECT_LIGHTS);
	return (struct light_tree_lamps){
	    .materials = scene_section(scene, BLOB_MATERIALS),
	    .vertices = scene_section(scene, BLOB_VERTICES),
	    .triangles = scene_section(scene, BLOB_TRIANGLES),
	    .emitters = scene_section(scene, BLOB_EMITTERS),
	    .emitter_count = emitters ? scene_count(scene, BLOB_EMITTERS) : 0,
	    .lights = scene_section(scene, BLOB_LIGHTS),
	    .light_count = lights ? scene_count(scene, BLOB_LIGHTS) : 0,
	    .first_light = scene_count(scene, BLOB_EMITTERS),
	};
}

bool pt_light_tree_wanted(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan)
{
	const struct light_tree_lamps lamps = lamps_of(scene, plan);
	const uint64_t count = (uint64_t)lamps.emitter_count + lamps.light_count;
	if (pt_settings(plan)->lamps == LAMPS_BY_CHANCE || pt_settings(plan)->light_tree == LIGHT_TREE_OFF)
		return false;
	if (count == 0 || count > LIGHT_TREE_LAMPS_MAX)
		return false;
	// Shaders read its nodes from a texel buffer.
	if (pt_light_tree_bytes(scene, plan) / PIPELINE_TEXEL_BYTES > devices->vk->limits.maxTexelBufferElements)
		return false;
	return pt_settings(plan)->light_tree == LIGHT_TREE_ON || lamps.emitter_count >= TREE_FROM_EMITTERS ||
	       lamps.light_count >= TREE_FROM_LIGHTS;
}

uint64_t pt_light_tree_bytes(const struct resident_scene *scene, const struct plan *plan)
{
	const struct light_tree_lamps lamps = lamps_of(scene, plan);
	return (uint64_t)light_tree_nodes(lamps.emitter_count + lamps.light_count) * sizeof(struct light_node) +
	       (uint64_t)lamps.emitter_count * sizeof(uint32_t);
}

static void light_tree_destroy(struct derived *derived)
{
	struct tree *t = (struct tree *)derived;
	buffer_finish(&t->buffers.nodes, t->device);
	buffer_finish(&t->buffers.trails, t->device);
	free(t);
}

static uint64_t light_tree_idle_bytes(const struct derived *derived)
{
	const struct tree *t = (const struct tree *)derived;
	return t->buffers.nodes.allocated + t->buffers.trails.allocated;
}

static enum status make(struct tree *t, const struct light_tree_lamps *lamps, struct error *err)
{
	const uint32_t count = lamps->emitter_count + lamps->light_count;
	// At least one trail, because no buffer is empty.
	const uint64_t trail_count = lamps->emitter_count > 0 ? lamps->emitter_count : 1;
	const uint64_t node_bytes = (uint64_t)light_tree_nodes(count) * sizeof(struct light_node);
	struct light_node *nodes = malloc(node_bytes);
	uint32_t *trails = calloc(trail_count, sizeof *trails);
	enum status s;
	if (!nodes || !trails)
		s = error_set(err, STATUS_MEMORY, "no memory for a tree of %u lamps", count);
	else
		s = light_tree_build(lamps, nodes, trails, err);
	if (s == STATUS_OK)
		s = buffer_init_with(&t->buffers.nodes, t->device, nodes, node_bytes, err);
	if (s == STATUS_OK)
		s = buffer_init_with(&t->buffers.trails, t->device, trails, trail_count * sizeof *trails, err);
	free(nodes);
	free(trails);
	return s;
}

enum status pt_light_tree_get(struct device *device, struct resident_scene *scene, const struct plan *plan,
			      const struct emitter_cells *cells, const struct pt_light_tree **out, uint64_t *us,
			      struct error *err)
{
	struct light_tree_lamps lamps = lamps_of(scene, plan);
	lamps.grids = cells ? cells->grids : NULL;
	const char *kind = &kinds[(lamps.emitter_count > 0 ? 1 : 0) + (lamps.light_count > 0 ? 2 : 0) + (cells ? 4 : 0)];
	const uint64_t start = clock_us();
	struct tree *t = (struct tree *)resident_derived(scene, kind);
	enum status s = STATUS_OK;
	if (!t) {
		t = calloc(1, sizeof *t);
		if (!t)
			return error_set(err, STATUS_MEMORY, "out of memory");
		t->derived = (struct derived){.kind = kind, .destroy = light_tree_destroy, .bytes = light_tree_idle_bytes};
		t->device = device;
		s = make(t, &lamps, err);
		if (s == STATUS_OK)
			resident_derive(scene, &t->derived);
		else
			light_tree_destroy(&t->derived);
		*us += clock_us() - start;
	}
	if (s == STATUS_OK)
		*out = &t->buffers;
	return s;
}
