#include "server/worker/technique/radiosity/element_groups.h"

#include <stdlib.h>

// The triangles of a node are consecutive, and so are the faces that begin at them, and these faces' patches.
enum status element_groups_init(struct element_groups *g, const struct blob_view *scene, const struct elements *elements,
				struct error *err)
{
	const struct scene_node *nodes = scene->sections[BLOB_SCENE_NODES];
	const struct patches *p = &elements->patches;
	*g = (struct element_groups){.nodes = scene->counts[BLOB_SCENE_NODES], .patches = p->count};
	g->first = calloc((size_t)g->nodes + 1, sizeof *g->first);
	if (!g->first)
		return error_set(err, STATUS_MEMORY, "out of memory");
	uint32_t face = 0, triangle = 0;
	for (uint32_t i = 0; i < g->nodes; i++) {
		// A node without triangles may have any first one.
		if (nodes[i].triangle_count > 0)
			triangle = nodes[i].first_triangle + nodes[i].triangle_count;
		g->first[i] = face < p->faces.count ? p->cuts[face].first : p->count;
		while (face < p->faces.count && p->faces.list[face].triangle[0] < triangle)
			face++;
	}
	g->first[g->nodes] = p->count;
	return STATUS_OK;
}

void element_groups_finish(struct element_groups *g)
{
	free(g->first);
	*g = (struct element_groups){0};
}

static uint32_t node_of(const struct element_groups *g, uint32_t patch)
{
	uint32_t low = 0, high = g->nodes; // the node is low, or between
	while (high - low > 1) {
		const uint32_t mid = low + (high - low) / 2;
		if (g->first[mid] <= patch)
			low = mid;
		else
			high = mid;
	}
	return low;
}

uint32_t element_groups_find(const struct element_groups *g, uint32_t element)
{
	const bool back = element >= g->patches;
	return 2 * node_of(g, back ? element - g->patches : element) + back;
}

uint32_t element_groups_elements(const struct element_groups *g, uint32_t group, uint32_t *first)
{
	const uint32_t node = group / 2;
	*first = g->first[node] + (group % 2 ? g->patches : 0);
	return g->first[node + 1] - g->first[node];
}
