// A scene blob from a loader gone wrong: blob_check refuses it, or every section can be read to its end, and what a worker
// makes of a scene on the host can be made of it: facts, tables of lights, casters and cells, and the scene after edits.
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "server/scene/casters.h"
#include "server/scene/emitter_cells.h"
#include "server/scene/facts.h"
#include "server/scene/light_tree.h"
#include "server/worker/scenes/edit.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

// Are the sections within the blob?
static void look_at_sections(const struct blob_header *blob, size_t size)
{
	for (int s = 0; s < BLOB_SECTIONS; s++) {
		const unsigned char *bytes = blob_section(blob, (enum blob_section)s);
		const size_t n = blob_count(blob, (enum blob_section)s) * blob_stride((enum blob_section)s);
		for (size_t i = 0; i < n; i++)
			if (bytes + i >= (const unsigned char *)blob + size)
				abort();
	}
}

static void make_tree(const struct blob_view *view, const struct emitter_grid *grids)
{
	struct error err;
	const struct light_tree_lamps lamps = {.materials = view->sections[BLOB_MATERIALS],
					       .vertices = view->sections[BLOB_VERTICES],
					       .triangles = view->sections[BLOB_TRIANGLES],
					       .emitters = view->sections[BLOB_EMITTERS],
					       .grids = grids,
					       .emitter_count = view->counts[BLOB_EMITTERS],
					       .lights = view->sections[BLOB_LIGHTS],
					       .light_count = view->counts[BLOB_LIGHTS],
					       .first_light = view->counts[BLOB_EMITTERS]};
	const uint32_t count = lamps.emitter_count + lamps.light_count;
	if (count == 0 || count > LIGHT_TREE_LAMPS_MAX)
		return;
	struct light_node *nodes = malloc(light_tree_nodes(count) * sizeof *nodes);
	uint32_t *trails = calloc(lamps.emitter_count + 1u, sizeof *trails);
	if (nodes && trails)
		light_tree_build(&lamps, nodes, trails, &err);
	free(nodes);
	free(trails);
}

static void make_tables(const struct blob_view *view)
{
	struct error err;
	struct emitter_cells cells = {0};
	struct emitter *rows = NULL;
	uint32_t count;
	float *density = calloc(view->counts[BLOB_MATERIALS], sizeof *density);
	facts_of_view(view);
	facts_by_name(view);
	facts_given(view, 0, ~0u);
	facts_given(view, ~0u, 0);
	if (density && casters_count(view) > 0)
		casters_make_table(view, &rows, &count, density, &err);
	free(rows);
	free(density);
	if (view->counts[BLOB_EMITTERS] > 0)
		emitter_cells_init(&cells, view, &err);
	make_tree(view, emitter_cells_wanted(view) ? cells.grids : NULL);
	emitter_cells_finish(&cells);
}

// The first node, material and animation are edited, whatever they are called, and a light is added.
static void edit(const struct blob_view *view)
{
	static candil_Edits edits;
	struct edited edited;
	struct error err;
	edits = (candil_Edits){.lights_count = 1, .materials_count = 1, .nodes_count = 1, .animation = "#0", .time_s = 0.5};
	edits.lights[0].intensity.x = 1;
	strcpy(edits.materials[0].name, "#0");
	edits.materials[0].has_emission = true;
	edits.materials[0].emission.y = 2;
	strcpy(edits.nodes[0].name, "#0");
	edits.nodes[0].has_translation = true;
	edits.nodes[0].translation.x = 1;
	if (view->counts[BLOB_ANIMATIONS] == 0)
		edits.animation[0] = '\0';
	if (edit_apply(view, &edits, &edited, &err) == STATUS_OK)
		make_tables(&edited.view);
	edited_finish(&edited);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct error err;
	struct blob_view view;
	void *blob = aligned_alloc(BLOB_ALIGN, (size / BLOB_ALIGN + 1) * BLOB_ALIGN);
	if (!blob)
		return 0;
	memcpy(blob, data, size);
	if (blob_check(blob, size, &err) == STATUS_OK) {
		look_at_sections(blob, size);
		blob_view_init(&view, blob);
		make_tables(&view);
		edit(&view);
	}
	free(blob);
	return 0;
}
