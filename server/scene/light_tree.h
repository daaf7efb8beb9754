// A tree over the triangles that emit, so that a place chooses among thousands of lamps those that matter to it: Conty
// Estevez and Kulla 2018, "Importance sampling of many lights with adaptive tree splitting". Each node bounds where its
// lamps are, how much they send in all, and the cone of their normals; shaders/common/light_tree.glsl walks it.
//
// Equal input gives equal bits. One thread; it takes some time: n log n.
#ifndef CANDIL_SCENE_LIGHT_TREE_H
#define CANDIL_SCENE_LIGHT_TREE_H

#include "server/base/error.h"
#include "shaders/shared/layout.h"

// More emitters than this get no tree.
#define LIGHT_TREE_EMITTERS_MAX (1u << 18)

// A tree of `count` emitters, 1 … LIGHT_TREE_EMITTERS_MAX, has this many nodes.
static inline uint32_t light_tree_nodes(uint32_t count)
{
	return 2 * count - 1;
}

// Fill in light_tree_nodes(count) nodes, the root first and the children of a node side by side, and for each emitter its
// trail: the way from the root, a bit a level from the lowest up, 1 for the second child. No leaf is deeper than 31 levels.
// An emitter's power is area · its material's power_density. STATUS_MEMORY.
enum status light_tree_build(const struct material *materials, const struct vertex *vertices,
			     const struct triangle *triangles, const struct emitter *emitters, uint32_t count,
			     struct light_node *nodes, uint32_t *trails, struct error *err);

#endif
