// Groups of elements: those of one node of the scene on one side. Node n has two, the fronts of its patches, group 2 n, and
// their backs, group 2 n + 1. The elements of a group follow each other. Host only, any thread.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_ELEMENT_GROUPS_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_ELEMENT_GROUPS_H

#include "server/worker/technique/radiosity/elements.h"

// The groups of a scene.
struct element_groups {
	uint32_t *first; // by node, and one more: its first patch
	uint32_t nodes;
	uint32_t patches;
};

// Find them. STATUS_MEMORY: `groups` is empty then.
enum status element_groups_init(struct element_groups *groups, const struct blob_view *scene,
				const struct elements *elements, struct error *err);

// Free them. Groups that are all zero are fine.
void element_groups_finish(struct element_groups *groups);

// The group of an element.
uint32_t element_groups_find(const struct element_groups *groups, uint32_t element);

// Of a group, below 2 · nodes, its elements: returns how many follow *first. 0 of a node without patches.
uint32_t element_groups_elements(const struct element_groups *groups, uint32_t group, uint32_t *first);

#endif
