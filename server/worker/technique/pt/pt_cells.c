#include "server/worker/technique/pt/pt_cells.h"

#include <stdlib.h>

#include "server/worker/technique/pt/pt_options.h"

struct cells {
	struct derived derived;
	struct device *device;
	struct pt_cells own;
};

static const char kind;

bool pt_cells_wanted(const struct resident_scene *scene, const struct plan *plan)
{
	return plan_has(plan, candil_Effect_EFFECT_EMITTERS) && plan_has(plan, candil_Effect_EFFECT_TEXTURES) &&
	       pt_settings(plan)->lamps != LAMPS_BY_CHANCE &&
	       (resident_derived(scene, &kind) || emitter_cells_wanted(&scene->view));
}

uint64_t pt_cells_bytes(const struct resident_scene *scene)
{
	const struct cells *c = (const struct cells *)resident_derived(scene, &kind);
	const uint64_t count = c ? c->own.tables.cell_count : emitter_cells_count(&scene->view);
	return (uint64_t)scene_count(scene, BLOB_EMITTERS) * (sizeof(struct emitter_grid) + sizeof(struct emitter)) +
	       count * sizeof(struct emitter_cell);
}

static void cells_destroy(struct derived *derived)
{
	struct cells *c = (struct cells *)derived;
	buffer_finish(&c->own.grids, c->device);
	buffer_finish(&c->own.cells, c->device);
	buffer_finish(&c->own.emitters, c->device);
	emitter_cells_finish(&c->own.tables);
	free(c);
}

static uint64_t cells_idle_bytes(const struct derived *derived)
{
	const struct pt_cells *c = &((const struct cells *)derived)->own;
	return c->grids.allocated + c->cells.allocated + c->emitters.allocated;
}

static enum status make(struct cells *c, const struct resident_scene *scene, struct error *err)
{
	struct pt_cells *own = &c->own;
	struct emitter_cells *t = &own->tables;
	enum status s = emitter_cells_init(t, &scene->view, err);
	if (s == STATUS_OK)
		s = buffer_init_with(&own->grids, c->device, t->grids, t->count * sizeof *t->grids, err);
	if (s == STATUS_OK)
		s = buffer_init_with(&own->cells, c->device, t->cells, t->cell_count * sizeof *t->cells, err);
	if (s == STATUS_OK)
		s = buffer_init_with(&own->emitters, c->device, t->emitters, t->count * sizeof *t->emitters, err);
	emitter_cells_trim(t);
	return s;
}

enum status pt_cells_get(struct device *device, struct resident_scene *scene, const struct pt_cells **out, struct error *err)
{
	struct cells *c = (struct cells *)resident_derived(scene, &kind);
	if (!c) {
		c = calloc(1, sizeof *c);
		if (!c)
			return error_set(err, STATUS_MEMORY, "out of memory");
		c->derived = (struct derived){.kind = &kind, .destroy = cells_destroy, .bytes = cells_idle_bytes};
		c->device = device;
		const enum status s = make(c, scene, err);
		if (s != STATUS_OK) {
			cells_destroy(&c->derived);
			return s;
		}
		resident_derive(scene, &c->derived);
	}
	*out = &c->own;
	return STATUS_OK;
}
