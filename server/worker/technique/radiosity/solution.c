#include "server/worker/technique/radiosity/solution.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/angle.h"
#include "server/base/clock.h"
#include "server/scene/lights.h"
#include "server/worker/code_list.h"
#include "server/worker/technique/radiosity/corners.h"
#include "server/worker/technique/radiosity/light.h"
#include "server/worker/technique/radiosity/radiosity_options.h"
#include "server/worker/technique/radiosity/row_maker.h"
#include "server/worker/technique/radiosity/solver.h"
#include "server/worker/technique/radiosity/surfaces.h"

#define LAMP_AREA_MOST 0.0625 // share of all surfaces up to which lamps are small beside the scene

// Share of the work that each stage counts for, for progress.
static const double shares[SOLUTION_STAGES] = {[SOLUTION_SURFACES] = 0.02,
					       [SOLUTION_LIGHT] = 0.08,
					       [SOLUTION_FACTORS] = 0.7,
					       [SOLUTION_SOLVE] = 0.18,
					       [SOLUTION_CORNERS] = 0.02};

// Free what only the making needs.
static void finish_making(struct solution *v)
{
	solver_destroy(v->solver);
	if (v->rows_by)
		factor_build_pause(v->factors, v->rows_by);
	row_maker_destroy(v->rows_by);
	light_destroy(v->light);
	surfaces_destroy(v->surfaces);
	buffer_finish(&v->buffers.surfaces, v->device);
	v->solver = NULL;
	v->rows_by = NULL;
	v->light = NULL;
	v->surfaces = NULL;
	v->scene = NULL;
}

static void solution_destroy(struct shelved *shelved, bool scene_goes)
{
	struct solution *v = (struct solution *)shelved;
	finish_making(v);
	if (!scene_goes)
		factor_build_release(v->factors);
	free(v->made_of);
	free(v->direct);
	free(v->irradiance);
	free(v->corners);
	free(v->reached);
	free(v);
}

static bool solution_is_finished(const struct shelved *shelved)
{
	return solution_finished((const struct solution *)shelved);
}

// Once it is done it has no device memory of its own, but it holds the factors.
static uint64_t solution_idle_bytes(const struct shelved *shelved)
{
	const struct solution *v = (const struct solution *)shelved;
	return v->factors->shelved.users == 1 ? factors_bytes(&v->factors->factors) : 0;
}

static const struct shelf_kind kind = {
    .kept = 2, .finished = solution_is_finished, .bytes = solution_idle_bytes, .destroy = solution_destroy};

// ---- making one ---------------------------------------------------------------------------------------------------------

static enum status make_passes(struct solution *v, struct gl_device *gl, const struct plan *plan, struct error *err)
{
	const struct factor_options *f = &v->options.factors;
	const struct patch_scene of = {plan, v->scene, &v->factors->elements, &v->buffers};
	const struct light_options light = {
	    .points = v->options.points, .sky_points = v->options.sky_points, .lamps = v->lamps, .bounces = f->rows.bounces};
	const struct code_list *code = v->device->code;
	const uint32_t added = code ? code->added : 0;
	const uint64_t start = clock_us();
	enum status s = surfaces_create(&of, v->device, &v->surfaces, err);
	if (s == STATUS_OK)
		s = surfaces_compile(v->surfaces, err);
	if (s == STATUS_OK && light_wanted(plan, v->scene, v->lamps))
		s = light_create(&of, &light, v->device, &v->light, err);
	if (s == STATUS_OK && v->light)
		s = light_compile(v->light, err);
	if (s == STATUS_OK)
		s = row_maker_create(&of, &f->rows, v->made_of, v->device, gl, &v->rows_by, err);
	if (s == STATUS_OK)
		s = row_maker_compile(v->rows_by, err);
	if (s == STATUS_OK)
		s = solver_compile(v->device, (enum solver_way)v->options.solver, err);
	// What the driver has compiled before is made at once, and no time that is spent once.
	v->compile_us = !code || code->added != added ? clock_us() - start : 0;
	return s;
}

// Whether light of emissive surfaces is looked for by points on them: where they are small beside the scene. What mirrors
// show of them only chance finds that way, and form factors have more rays for it.
static bool lamps_by_points(const struct solution *v, const struct resident_scene *scene)
{
	const struct emitter *emitters = scene_section(scene, BLOB_EMITTERS);
	const struct triangle *triangles = scene_section(scene, BLOB_TRIANGLES);
	const struct vertex *vertices = scene_section(scene, BLOB_VERTICES);
	double lamps = 0, all = 0;
	if (v->options.emitters != RADIOSITY_EMITTERS_AUTO)
		return v->options.emitters == RADIOSITY_EMITTERS_POINTS;
	if (v->options.factors.rows.mirrors || !(v->options.effects >> candil_Effect_EFFECT_EMITTERS & 1u))
		return false;
	for (uint32_t i = 0; i < scene_count(scene, BLOB_EMITTERS); i++)
		lamps += lights_area(vertices, &triangles[emitters[i].triangle]);
	for (uint32_t i = 0; i < scene_count(scene, BLOB_TRIANGLES); i++)
		all += lights_area(vertices, &triangles[i]);
	return lamps <= LAMP_AREA_MOST * all;
}

static enum status make_arrays(struct solution *v, struct error *err)
{
	const size_t count = v->factors->elements.count;
	v->made_of = calloc(count + 1, sizeof *v->made_of);
	v->direct = calloc(3 * count + 1, sizeof *v->direct);
	v->irradiance = calloc(3 * count + 1, sizeof *v->irradiance);
	v->corners = calloc(12 * count + 1, sizeof *v->corners);
	return v->made_of && v->direct && v->irradiance && v->corners ? STATUS_OK
								      : error_set(err, STATUS_MEMORY, "out of memory");
}

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
	v->lamps = lamps_by_points(v, scene);
	enum status s = factor_build_acquire(scene, device, &options->factors, &v->factors, err);
	if (s != STATUS_OK) {
		free(v);
		return s;
	}
	const uint32_t count = v->factors->elements.count;
	v->buffers = v->factors->buffers;
	v->stage = count > 0 ? SOLUTION_SURFACES : SOLUTION_DONE;
	s = make_arrays(v, err);
	if (s == STATUS_OK && count > 0)
		s = buffer_init(&v->buffers.surfaces, device, count * sizeof *v->made_of, BUFFER_DEVICE, err);
	if (s == STATUS_OK && count > 0)
		s = make_passes(v, gl, plan, err);
	if (s == STATUS_OK)
		*out = v;
	else
		solution_destroy(&v->shelved, false);
	return s;
}

// Find a solution on the shelf. One that is being made reads the buffers of one variant, and serves its jobs alone.
static struct solution *solution_find(const struct shelf *s, const struct resident_scene *scene,
				      const struct solution_options *options)
{
	for (struct shelved *at = s->first; at; at = at->next) {
		struct solution *v = (struct solution *)at;
		if (!memcmp(&v->options, options, sizeof *options) && !memcmp(&v->keys, &scene->keys, sizeof v->keys) &&
		    (solution_finished(v) || v->scene == scene))
			return v;
	}
	return NULL;
}

enum status solution_acquire(struct resident_scene *scene, struct device *device, struct gl_device *gl,
			     const struct plan *plan, const struct solution_options *options, struct solution **solution,
			     struct error *err)
{
	struct shelf *shelf = shelf_of(scene, &kind);
	if (!shelf)
		return error_set(err, STATUS_MEMORY, "out of memory");
	struct solution *v = solution_find(shelf, scene, options);
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

// ---- the stages ---------------------------------------------------------------------------------------------------------

static bool has_background(const struct solution *v)
{
	return v->options.background[0] > 0 || v->options.background[1] > 0 || v->options.background[2] > 0;
}

static enum status do_surfaces(struct solution *v, uint32_t budget_us, struct error *err)
{
	enum status s = surfaces_step(v->surfaces, budget_us, err);
	if (s != STATUS_OK || !surfaces_finished(v->surfaces))
		return s;
	s = buffer_read(&v->buffers.surfaces, v->device, 0, v->factors->elements.count * sizeof *v->made_of, v->made_of,
			err);
	if (s == STATUS_OK)
		v->stage = SOLUTION_LIGHT;
	return s;
}

bool solution_is_lit(const struct solution *v, uint32_t element)
{
	bool lit = has_background(v);
	for (uint32_t c = 0; c < 3; c++)
		lit = lit || v->made_of[element].emission[c] > 0 || v->direct[3 * element + c] > 0;
	return lit;
}

static void want_lit(struct solution *v)
{
	for (uint32_t i = 0; i < v->factors->elements.count; i++)
		if (solution_is_lit(v, i))
			factor_build_want(v->factors, i);
}

static enum status do_light(struct solution *v, uint32_t budget_us, struct error *err)
{
	enum status s = STATUS_OK;
	if (v->light) {
		s = light_step(v->light, budget_us, err);
		if (s != STATUS_OK || !light_finished(v->light))
			return s;
		s = light_read(v->light, v->direct, err);
	}
	if (s != STATUS_OK)
		return s;
	want_lit(v);
	v->rows = v->factors->rows;
	v->stage = SOLUTION_FACTORS;
	return STATUS_OK;
}

// The irradiance of an even background is π L times the share of light that meets nothing.
static void add_background(struct solution *v)
{
	for (uint32_t i = 0; i < v->factors->elements.count; i++)
		for (uint32_t c = 0; c < 3; c++)
			v->direct[3 * i + c] += (float)PI * v->options.background[c] * v->factors->factors.rows[i].escaped;
}

static enum status begin_solving(struct solution *v, struct error *err)
{
	const struct elements *e = &v->factors->elements;
	const bool bounces = v->options.effects >> candil_Effect_EFFECT_BOUNCES & 1u;
	float *all = calloc(7 * (size_t)e->count, sizeof *all); // exitance, albedo, areas
	if (!all)
		return error_set(err, STATUS_MEMORY, "out of memory");
	float *exitance = all, *albedo = all + 3 * (size_t)e->count, *area = albedo + 3 * (size_t)e->count;
	for (uint32_t i = 0; i < e->count; i++) {
		for (uint32_t c = 0; c < 3; c++) {
			exitance[3 * i + c] = v->lamps ? 0 : (float)PI * v->made_of[i].emission[c];
			albedo[3 * i + c] = bounces ? v->made_of[i].albedo[c] : 0;
		}
		area[i] = e->shapes[i % e->patches.count].area;
	}
	const struct solver_problem problem = {.factors = &v->factors->factors,
					       .exitance = exitance,
					       .albedo = albedo,
					       .irradiance = v->direct,
					       .area = area,
					       .way = (enum solver_way)v->options.solver,
					       .residual = (double)v->options.residual,
					       .iterations = LIMIT_RADIOSITY_ITERATIONS};
	const enum status s = solver_create(&problem, v->device, &v->solver, err);
	free(all);
	return s;
}

static enum status do_factors(struct solution *v, uint32_t budget_us, struct error *err)
{
	enum status s = factor_build_step(v->factors, v->rows_by, budget_us, err);
	if (s != STATUS_OK || !factor_build_finished(v->factors))
		return s;
	v->rows = v->factors->rows - v->rows;
	if (has_background(v))
		add_background(v);
	v->stage = SOLUTION_SOLVE;
	return STATUS_OK;
}

static enum status do_solve(struct solution *v, uint32_t budget_us, struct error *err)
{
	enum status s = v->solver ? STATUS_OK : begin_solving(v, err);
	if (s == STATUS_OK)
		s = solver_step(v->solver, budget_us, err);
	if (s != STATUS_OK || !solver_finished(v->solver))
		return s;
	v->residual = solver_residual(v->solver);
	v->iterations = solver_iterations(v->solver);
	s = solver_read(v->solver, v->irradiance, err);
	if (s == STATUS_OK)
		v->stage = SOLUTION_CORNERS;
	return s;
}

static enum status do_corners(struct solution *v, uint32_t budget_us, struct error *err)
{
	struct corners *corners = v->factors->corners;
	const uint32_t count = v->factors->elements.count;
	if (!corners_finished(corners))
		return corners_step(corners, budget_us, err);
	uint8_t *reached = malloc(count);
	if (!reached)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; i < count; i++)
		reached[i] = factor_build_has(v->factors, i);
	corners_values(corners, v->irradiance, reached, v->corners);
	free(reached);
	v->stage = SOLUTION_DONE;
	finish_making(v);
	return STATUS_OK;
}

static enum status do_piece(struct solution *v, uint32_t budget_us, struct error *err)
{
	switch (v->stage) {
	case SOLUTION_SURFACES:
		return do_surfaces(v, budget_us, err);
	case SOLUTION_LIGHT:
		return do_light(v, budget_us, err);
	case SOLUTION_FACTORS:
		return do_factors(v, budget_us, err);
	case SOLUTION_SOLVE:
		return do_solve(v, budget_us, err);
	case SOLUTION_CORNERS:
		return do_corners(v, budget_us, err);
	default:
		return STATUS_OK;
	}
}

enum status solution_step(struct solution *v, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	uint64_t spent = 0;
	enum status s = STATUS_OK;
	while (s == STATUS_OK && !solution_finished(v) && spent < budget_us) {
		const enum solution_stage stage = v->stage;
		const uint64_t before = clock_us();
		s = do_piece(v, budget_us - (uint32_t)spent, err);
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
	if (v->stage == SOLUTION_FACTORS)
		within = factor_build_fraction(v->factors);
	else if (v->stage == SOLUTION_SOLVE && v->solver)
		within = fmin(1, log(fmin(1, solver_residual(v->solver))) / log((double)v->options.residual));
	return solution_finished(v) ? 1 : done + shares[v->stage] * (within > 0 ? within : 0);
}

void solution_account(const struct solution *v, bool made, struct frame *f)
{
	static const char *const names[SOLUTION_STAGES] = {"surfaces", "patch-light", "factors", "solve", "corners"};
	const struct elements *e = &v->factors->elements;
	const struct factors *m = &v->factors->factors;
	for (unsigned i = 0; i < SOLUTION_DONE; i++)
		if (made && v->stage_us[i] > 0)
			frame_add_stage(f, names[i], v->stage_us[i]);
	frame_add_figure(f, "patches", e->patches.count, "");
	frame_add_figure(f, "edge", e->patches.edge, "m");
	frame_add_figure(f, "rows", (double)v->factors->rows + v->factors->taken, "");
	frame_add_figure(f, "rows.made", made ? (double)v->rows : 0, "");
	frame_add_figure(f, "factors", (double)m->entries, "");
	frame_add_figure(f, "bytes.factors", (double)factors_bytes(m), "bytes");
	frame_add_figure(f, "iterations", v->iterations, "");
	frame_add_figure(f, "residual", v->residual, "");
}

uint64_t solution_take_compile_us(struct solution *v)
{
	const uint64_t us = v->compile_us;
	v->compile_us = 0;
	return us;
}
