#include "server/worker/technique/radiosity/solution.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/worker/technique/radiosity/solution_parts.h"
#include "server/worker/technique/radiosity/solver.h"
#include "server/worker/technique/radiosity/surfaces.h"

// Share of the work that each stage counts for, for progress.
static const double shares[SOLUTION_STAGES] = {
    [SOLUTION_SURFACES] = 0.02, [SOLUTION_LIGHT] = 0.08, [SOLUTION_FACTORS] = 0.7,
    [SOLUTION_PROJECT] = 0.03,  [SOLUTION_SOLVE] = 0.15, [SOLUTION_CORNERS] = 0.02};

static void solution_destroy(struct shelved *shelved, bool scene_goes)
{
	struct solution *v = (struct solution *)shelved;
	solution_finish_making(v);
	if (!scene_goes)
		factor_build_release(v->factors);
	for (uint32_t i = 0; i < 2; i++)
		display_field_finish(&v->fields[i]);
	free(v->made_of);
	free(v->direct);
	free(v->irradiance);
	free(v->corners);
	factors_finish(&v->projected);
	free(v->reached);
	free(v);
}

static bool solution_is_finished(const struct shelved *shelved)
{
	return solution_finished((const struct solution *)shelved);
}

// Once it is done it has what pictures are made of, and it holds the factors.
static uint64_t solution_idle_bytes(const struct shelved *shelved)
{
	const struct solution *v = (const struct solution *)shelved;
	const struct elements *e = &v->factors->elements;
	uint64_t bytes = v->factors->shelved.users == 1 ? factors_bytes(&v->factors->factors) : 0;
	for (uint32_t i = 0; i < 2; i++)
		if (v->fields[i].patches > 0)
			bytes += display_field_bytes(e->patches.faces.count, e->triangle_count, e->patches.count, i == 1);
	return bytes + factors_bytes(&v->projected);
}

static const struct shelf_kind kind = {
    .kept = 2, .finished = solution_is_finished, .bytes = solution_idle_bytes, .destroy = solution_destroy};

// ---- making one ---------------------------------------------------------------------------------------------------------

static enum status solution_create(struct resident_scene *scene, struct device *device, struct gl_device *gl,
				   const struct plan *plan, const struct solution_options *options, struct solution **out,
				   struct error *err)
{
	struct solution *v = calloc(1, sizeof *v);
	if (!v)
		return error_set(err, STATUS_MEMORY, "out of memory");
	v->options = *options;
	v->keys = scene->keys;
	v->device = device;
	v->scene = scene;
	enum status s = factor_build_acquire(scene, device, &options->factors, &v->factors, err);
	if (s != STATUS_OK) {
		free(v);
		return s;
	}
	s = solution_make_ready(v, gl, plan, err);
	if (s == STATUS_OK)
		*out = v;
	else
		solution_destroy(&v->shelved, false);
	return s;
}

// Find a solution on the shelf. One that is being made reads the buffers of one variant, and one file, and serves their jobs
// alone.
static struct solution *solution_find(const struct shelf *s, const struct resident_scene *scene,
				      const struct resident_scene *imported, const struct solution_options *options)
{
	for (struct shelved *at = s->first; at; at = at->next) {
		struct solution *v = (struct solution *)at;
		if (!memcmp(&v->options, options, sizeof *options) && !memcmp(&v->keys, &scene->keys, sizeof v->keys) &&
		    (solution_finished(v) || (v->scene == scene && v->imported == imported)))
			return v;
	}
	return NULL;
}

bool solution_is_made(struct resident_scene *scene, const struct solution_options *options)
{
	const struct shelf *shelf = shelf_of(scene, &kind);
	const struct solution *v = shelf ? solution_find(shelf, scene, NULL, options) : NULL;
	return v && solution_finished(v);
}

enum status solution_acquire(struct resident_scene *scene, struct device *device, struct gl_device *gl,
			     const struct plan *plan, const struct solution_options *options, struct solution **solution,
			     struct error *err)
{
	struct shelf *shelf = shelf_of(scene, &kind);
	if (!shelf)
		return error_set(err, STATUS_MEMORY, "out of memory");
	struct solution *v = solution_find(shelf, scene, plan->imported.scene, options);
	if (!v) {
		enum status s;
		while (shelf_drop_idle(shelf, kind.kept - 1))
			;
		do
			s = solution_create(scene, device, gl, plan, options, &v, err);
		while (s == STATUS_MEMORY && shelf_drop_idle(shelf, 0));
		if (s != STATUS_OK)
			return s;
		shelf_put(shelf, &v->shelved);
	}
	shelf_hold(&v->shelved);
	*solution = v;
	return STATUS_OK;
}

void solution_release(struct solution *v)
{
	if (v)
		shelf_release(&v->shelved);
}

// ---- how far it is -------------------------------------------------------------------------------------------------------

enum status solution_step(struct solution *v, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	uint64_t spent = 0;
	enum status s = STATUS_OK;
	while (s == STATUS_OK && !solution_finished(v) && spent < budget_us) {
		const enum solution_stage stage = v->stage;
		const uint64_t before = clock_us();
		s = solution_work(v, budget_us - (uint32_t)spent, err);
		v->stage_us[stage] += clock_us() - before;
		spent = clock_us() - start;
	}
	return s;
}

bool solution_finished(const struct solution *v)
{
	return v->stage == SOLUTION_DONE;
}

double solution_fraction(const struct solution *v)
{
	double done = 0, within = 0;
	for (unsigned i = 0; i < v->stage; i++)
		done += shares[i];
	if (v->stage == SOLUTION_SURFACES && factor_build_ready(v->factors))
		within = (double)surfaces_progress(v->surfaces);
	else if (v->stage == SOLUTION_FACTORS)
		within = reach_fraction(&v->reach);
	else if (v->stage == SOLUTION_SOLVE && v->solver)
		within = fmin(1, log(fmin(1, solver_residual(v->solver))) / log((double)v->options.residual));
	return solution_finished(v) ? 1 : done + shares[v->stage] * (within > 0 ? within : 0);
}

enum status solution_field(struct solution *v, struct gl_device *gl, bool corners, const struct display_field **field,
			   struct error *err)
{
	struct display_field *f = &v->fields[corners];
	const struct elements *e = &v->factors->elements;
	enum status s = STATUS_OK;
	if (f->patches == 0 && e->count > 0)
		s = display_field_init(f, gl, e, corners ? v->corners : v->irradiance, corners, err);
	*field = f;
	return s;
}

void solution_account(const struct solution *v, bool made, struct frame *f)
{
	static const char *const names[SOLUTION_STAGES] = {"surfaces", "import", "patch-light", "factors",
							   "project",  "solve",  "corners"};
	const struct elements *e = &v->factors->elements;
	const struct factors *m = &v->factors->factors;
	for (unsigned i = 0; i < SOLUTION_DONE; i++)
		if (made && v->stage_us[i] > 0)
			frame_add_stage(f, names[i], v->stage_us[i]);
	frame_add_figure(f, "patches", e->patches.count, "");
	frame_add_figure(f, "edge", e->patches.edge, "m");
	frame_add_figure(f, "rows", (double)v->factors->rows + v->factors->taken, "");
	frame_add_figure(f, v->options.factors.rows.way == ROWS_IMPORTED ? "rows.imported" : "rows.made",
			 made ? (double)v->rows : 0, "");
	frame_add_figure(f, "factors", (double)m->entries, "");
	frame_add_figure(f, "bytes.factors", (double)(factors_bytes(m) + factors_bytes(&v->projected)), "bytes");
	frame_add_figure(f, "iterations", v->iterations, "");
	frame_add_figure(f, "residual", v->residual, "");
}

uint64_t solution_take_compile_us(struct solution *v)
{
	const uint64_t us = v->compile_us;
	v->compile_us = 0;
	return us;
}
