// A tree over the lamps of a scene, so that a place chooses among thousands, or between a near one and a bright one, those
// that matter to it: Conty Estevez and Kulla 2018, "Importance sampling of many lights with adaptive tree splitting". Each
// node bounds where its lamps are, how much they send at the most, and the cone of their normals; directional lights, which
// are nowhere, have a subtree of their own, whose cones are about the ways that their light travels.
// shaders/common/light_tree.glsl walks it.
//
// Equal input gives equal bits. One thread; it takes some time: n log n.
#ifndef CANDIL_SCENE_LIGHT_TREE_H
#define CANDIL_SCENE_LIGHT_TREE_H

#include "server/base/error.h"
#include "shaders/shared/layout.h"

// More lamps than this get no tree.
#define LIGHT_TREE_LAMPS_MAX (1u << 18)

// What the tree is made over, all of it the caller's. An emitter's number is its own, a light's is first_light and its own.
struct light_tree_lamps {
	const struct material *materials;
	const struct vertex *vertices;
	const struct triangle *triangles;
	const struct emitter *emitters; // those of materials that emit
	uint32_t emitter_count;
	const struct punctual_light *lights; // those with a luminance
	uint32_t light_count;
	uint32_t first_light; // at least emitter_count
};

// A tree of `count` lamps, 1 … LIGHT_TREE_LAMPS_MAX, has this many nodes.
static inline uint32_t light_tree_nodes(uint32_t count)
{
	return 2 * count - 1;
}

// Fill in light_tree_nodes(emitter_count + light_count) nodes, the root first and the children of a node side by side, and
// for each emitter its trail: the way from the root, a bit a level from the lowest up, 1 for the second child. No leaf is
// deeper than 31 levels. STATUS_MEMORY.
enum status light_tree_build(const struct light_tree_lamps *lamps, struct light_node *nodes, uint32_t *trails,
			     struct error *err);

#endif
