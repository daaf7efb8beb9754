// The stages of making a solution.
#include <math.h>
#include <stdlib.h>

#include "server/base/angle.h"
#include "server/worker/technique/radiosity/corner_values.h"
#include "server/worker/technique/radiosity/imported.h"
#include "server/worker/technique/radiosity/light.h"
#include "server/worker/technique/radiosity/radiosity_options.h"
#include "server/worker/technique/radiosity/row_maker.h"
#include "server/worker/technique/radiosity/solution_parts.h"
#include "server/worker/technique/radiosity/solver.h"
#include "server/worker/technique/radiosity/surfaces.h"

void solution_finish_making(struct solution *v)
{
	solution_end_projecting(v);
	solver_destroy(v->solver);
	corner_values_destroy(v->at_corners);
	if (v->rows_by)
		factor_build_pause(v->factors, v->rows_by);
	row_maker_destroy(v->rows_by);
	reach_finish(&v->reach);
	light_destroy(v->light);
	surfaces_destroy(v->surfaces);
	buffer_finish(&v->buffers.surfaces, v->device);
	v->solver = NULL;
	v->at_corners = NULL;
	v->rows_by = NULL;
	v->light = NULL;
	v->surfaces = NULL;
	v->scene = NULL;
	v->imported = NULL;
}

static bool has_background(const struct solution *v)
{
	return v->options.background[0] > 0 || v->options.background[1] > 0 || v->options.background[2] > 0;
}

static enum status do_import(struct solution *v, uint32_t budget_us, struct error *err)
{
	const enum status s = imported_take(v, v->imported, &v->taken_next, budget_us, err);
	if (s == STATUS_OK && v->taken_next == v->factors->elements.count)
		v->stage = SOLUTION_CORNERS;
	return s;
}

bool solution_is_lit(const struct solution *v, uint32_t element)
{
	bool lit = has_background(v);
	for (uint32_t c = 0; c < 3; c++)
		lit = lit || v->made_of[element].emission[c] > 0 || v->direct[3 * element + c] > 0;
	return lit;
}

static enum status do_surfaces(struct solution *v, uint32_t budget_us, struct error *err)
{
	if (!factor_build_ready(v->factors))
		return factor_build_prepare(v->factors, budget_us, err);
	enum status s = surfaces_step(v->surfaces, budget_us, err);
	if (s != STATUS_OK || !surfaces_finished(v->surfaces))
		return s;
	s = buffer_read(&v->buffers.surfaces, v->device, 0, v->factors->elements.count * sizeof *v->made_of, v->made_of,
			err);
	if (s == STATUS_OK)
		v->stage = v->taken ? SOLUTION_IMPORT : SOLUTION_LIGHT;
	return s;
}

// Light begins in the groups of which some element is lit.
static enum status begin_reaching(struct solution *v, struct error *err)
{
	const struct element_groups *groups = &v->factors->groups;
	reach_finish(&v->reach);
	const enum status s = reach_init(&v->reach, groups, err);
	for (uint32_t g = 0; s == STATUS_OK && g < 2 * groups->nodes; g++) {
		uint32_t first;
		const uint32_t size = element_groups_elements(groups, g, &first);
		bool lit = false;
		for (uint32_t i = first; i < first + size && !lit; i++)
			lit = solution_is_lit(v, i);
		if (lit)
			reach_add(&v->reach, g);
	}
	return s;
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
	if (s == STATUS_OK)
		s = begin_reaching(v, err);
	if (s != STATUS_OK)
		return s;
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

enum status solution_create_solver(const struct solution *v, const float *start, struct solver **solver, struct error *err)
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
	const struct solver_problem problem = {.factors = solution_matrix(v),
					       .which = v->reached,
					       .exitance = exitance,
					       .albedo = albedo,
					       .irradiance = v->direct,
					       .area = area,
					       .way = (enum solver_way)v->options.solver,
					       .residual = (double)v->options.residual,
					       .iterations = LIMIT_RADIOSITY_ITERATIONS,
					       .start = start};
	const enum status s = solver_create(&problem, v->device, solver, err);
	free(all);
	return s;
}

static enum status do_factors(struct solution *v, uint32_t budget_us, struct error *err)
{
	enum status s = factor_build_step(v->factors, &v->reach, v->rows_by, budget_us, err);
	if (s != STATUS_OK || !reach_ended(&v->reach))
		return s;
	reach_list(&v->reach, v->reached);
	reach_finish(&v->reach);
	v->rows = v->factors->rows - v->rows;
	if (has_background(v))
		add_background(v);
	v->stage = v->options.project != RADIOSITY_PROJECT_NONE ? SOLUTION_PROJECT : SOLUTION_SOLVE;
	return STATUS_OK;
}

static enum status do_project(struct solution *v, uint32_t budget_us, struct error *err)
{
	bool done;
	const enum status s = solution_project(v, budget_us, &done, err);
	if (s == STATUS_OK && done)
		v->stage = SOLUTION_SOLVE;
	return s;
}

static enum status do_solve(struct solution *v, uint32_t budget_us, struct error *err)
{
	enum status s = v->solver ? STATUS_OK : solution_create_solver(v, NULL, &v->solver, err);
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
	if (!corners_finished(corners))
		return corners_step(corners, budget_us, err);
	if (!v->at_corners) {
		const enum status s =
		    corner_values_create(corners, v->irradiance, v->reached, v->corners, &v->at_corners, err);
		if (s != STATUS_OK)
			return s;
	}
	corner_values_step(v->at_corners, budget_us);
	if (!corner_values_finished(v->at_corners))
		return STATUS_OK;
	v->stage = SOLUTION_DONE;
	solution_finish_making(v);
	return STATUS_OK;
}

enum status solution_work(struct solution *v, uint32_t budget_us, struct error *err)
{
	switch (v->stage) {
	case SOLUTION_SURFACES:
		return do_surfaces(v, budget_us, err);
	case SOLUTION_IMPORT:
		return do_import(v, budget_us, err);
	case SOLUTION_LIGHT:
		return do_light(v, budget_us, err);
	case SOLUTION_FACTORS:
		return do_factors(v, budget_us, err);
	case SOLUTION_PROJECT:
		return do_project(v, budget_us, err);
	case SOLUTION_SOLVE:
		return do_solve(v, budget_us, err);
	case SOLUTION_CORNERS:
		return do_corners(v, budget_us, err);
	default:
		return STATUS_OK;
	}
}
