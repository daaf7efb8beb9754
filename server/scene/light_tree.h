// A tree over the lamps of a scene, with which a place chooses, among thousands of lamps or between a near and a bright
// one, those that matter to it: Conty Estevez and Kulla 2018, "Importance sampling of many lights with adaptive tree
// splitting". Each node bounds the positions of its lamps, their greatest emission and the cone of their normals.
// Directional lights have no position. They have a subtree of their own, whose cones bound the directions in which their
// light travels. shaders/common/light_tree.glsl walks the tree.
//
// Equal input gives equal bits. One thread. Building takes n log n time.
#ifndef CANDIL_SCENE_LIGHT_TREE_H
#define CANDIL_SCENE_LIGHT_TREE_H

#include "server/base/error.h"
#include "shaders/shared/layout.h"

// Scenes with more lamps than this get no tree.
#define LIGHT_TREE_LAMPS_MAX (1u << 18)

// The input of the tree; the caller owns all of it. In the tree an emitter has its own index as its number, a light
// first_light plus its index.
struct light_tree_lamps {
	const struct material *materials;
	const struct vertex *vertices;
	const struct triangle *triangles;
	const struct emitter *emitters; // emitters whose material emits
	const struct emitter_grid *grids; // of the emitters: emitter_cells.h; NULL: each sends its material's mean light
	uint32_t emitter_count;
	const struct punctual_light *lights; // lights whose luminance is above zero
	uint32_t light_count;
	uint32_t first_light; // at least emitter_count
};

// The number of nodes of a tree of `count` lamps, 1 … LIGHT_TREE_LAMPS_MAX.
static inline uint32_t light_tree_nodes(uint32_t count)
{
	return 2 * count - 1;
}

// Fill the caller's `nodes`, light_tree_nodes(emitter_count + light_count) of them: the root comes first, and the two
// children of a node are adjacent. Also fill `trails`, one for each emitter: its way from the root, one bit for each level
// from the lowest bit up, 1 for the second child. No leaf is deeper than 31 levels. STATUS_MEMORY.
enum status light_tree_build(const struct light_tree_lamps *lamps, struct light_node *nodes, uint32_t *trails,
			     struct error *err);

#endif
