#include "server/worker/scenes/edit.h"

#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "server/scene/facts.h"

static uint64_t hash_section(const struct blob_view *view, enum blob_section section)
{
	return XXH3_64bits(view->sections[section], view->counts[section] * blob_stride(section));
}

struct scene_keys edit_keys(const struct blob_view *base)
{
	return (struct scene_keys){.geometry = XXH3_64bits(base->blob->hash, sizeof base->blob->hash),
				   .lights = hash_section(base, BLOB_LIGHTS),
				   .materials = hash_section(base, BLOB_MATERIALS)};
}

static void make_keys(struct edited *e, const struct transform *world)
{
	e->keys = edit_keys(&e->view);
	for (uint32_t i = 0; i < e->move_count; i++) {
		const uint32_t node = e->moves[i].node;
		e->keys.geometry = XXH3_64bits_withSeed(&node, sizeof node, e->keys.geometry);
		e->keys.geometry = XXH3_64bits_withSeed(&world[node], sizeof world[node], e->keys.geometry);
	}
}

static enum status apply(struct edited *e, const candil_Edits *edits, struct transform *world, struct error *err)
{
	bool materials_changed;
	enum status status = edit_materials(e, edits, &materials_changed, err);
	if (status == STATUS_OK)
		status = edit_pose(e, edits, world, err);
	if (status == STATUS_OK && e->move_count > 0)
		status = edit_geometry(e, world, err);
	if (status == STATUS_OK && e->move_count > 0)
		status = edit_cameras(e, world, err);
	if (status == STATUS_OK)
		status = edit_lights(e, edits, world, err);
	if (status == STATUS_OK && (materials_changed || e->move_count > 0))
		status = edit_emitters(e, err);
	return status;
}

enum status edit_apply(const struct blob_view *base, const candil_Edits *edits, struct edited *out, struct error *err)
{
	*out = (struct edited){.view = *base, .cost_ratio = 1};
	struct transform *world = malloc((base->counts[BLOB_SCENE_NODES] + 1u) * sizeof *world);
	enum status status = world ? apply(out, edits, world, err) : error_set(err, STATUS_MEMORY, "no memory for an edit");
	if (status == STATUS_OK) {
		make_keys(out, world);
		out->view.facts = facts_of_view(&out->view);
	}
	free(world);
	if (status != STATUS_OK)
		edited_finish(out);
	return status;
}

void edited_finish(struct edited *e)
{
	for (unsigned s = 0; s < BLOB_SECTIONS; s++)
		free(e->own[s]);
	free(e->moves);
	*e = (struct edited){0};
}
