// What a solution is made with.
#include <stdlib.h>

#include "server/base/clock.h"
#include "server/scene/lights.h"
#include "server/worker/code_list.h"
#include "server/worker/technique/radiosity/imported.h"
#include "server/worker/technique/radiosity/light.h"
#include "server/worker/technique/radiosity/radiosity_options.h"
#include "server/worker/technique/radiosity/row_maker.h"
#include "server/worker/technique/radiosity/solution_parts.h"
#include "server/worker/technique/radiosity/solver.h"
#include "server/worker/technique/radiosity/surfaces.h"

#define LAMP_AREA_MOST 0.0625 // share of all surfaces up to which lamps are small beside the scene

// What finds light and rows, and solves.
static enum status make_finders(struct solution *v, const struct patch_scene *of, struct gl_device *gl, struct error *err)
{
	const struct factor_options *f = &v->options.factors;
	const struct light_options light = {
	    .points = v->options.points, .sky_points = v->options.sky_points, .lamps = v->lamps, .bounces = f->rows.bounces};
	enum status s = STATUS_OK;
	if (light_wanted(of->plan, v->scene, v->lamps))
		s = light_create(of, &light, v->device, &v->light, err);
	if (s == STATUS_OK && v->light)
		s = light_compile(v->light, err);
	if (s == STATUS_OK)
		s = row_maker_create(of, &f->rows, v->made_of, v->device, gl, &v->rows_by, err);
	if (s == STATUS_OK)
		s = row_maker_compile(v->rows_by, err);
	if (s == STATUS_OK)
		s = solver_compile(v->device, (enum solver_way)v->options.solver, err);
	return s;
}

static enum status make_passes(struct solution *v, struct gl_device *gl, const struct plan *plan, struct error *err)
{
	const struct patch_scene of = {plan, v->scene, &v->factors->elements, &v->buffers};
	const struct code_list *code = v->device->code;
	const uint32_t added = code ? code->added : 0;
	const uint64_t start = clock_us();
	bool *const covered = !v->taken && surfaces_cover(v->options.factors.rows.way) ? &v->factors->covered : NULL;
	enum status s = surfaces_create(&of, covered, v->device, &v->surfaces, err);
	if (s == STATUS_OK)
		s = surfaces_compile(v->surfaces, err);
	if (s == STATUS_OK && !v->taken)
		s = make_finders(v, &of, gl, err);
	// What the driver has compiled before is made at once, and no time that is spent once.
	v->compile_us = !code || code->added != added ? clock_us() - start : 0;
	return s;
}

// By points on them where they are small beside the scene. What mirrors show of them only chance finds that way, and form
// factors have more rays for it.
bool solution_finds_lamps(const struct solution_options *o, const struct resident_scene *scene)
{
	const struct emitter *emitters = scene_section(scene, BLOB_EMITTERS);
	const struct triangle *triangles = scene_section(scene, BLOB_TRIANGLES);
	const struct vertex *vertices = scene_section(scene, BLOB_VERTICES);
	double lamps = 0, all = 0;
	if (o->emitters != RADIOSITY_EMITTERS_AUTO)
		return o->emitters == RADIOSITY_EMITTERS_POINTS;
	if (o->factors.rows.mirrors || !(o->effects >> candil_Effect_EFFECT_EMITTERS & 1u))
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
	v->reached = calloc(count + 1, sizeof *v->reached);
	return v->made_of && v->direct && v->irradiance && v->corners && v->reached
		   ? STATUS_OK
		   : error_set(err, STATUS_MEMORY, "out of memory");
}

enum status solution_make_ready(struct solution *v, struct gl_device *gl, const struct plan *plan, struct error *err)
{
	const uint32_t count = v->factors->elements.count;
	v->imported = plan->imported.scene;
	v->taken = imported_solution(plan);
	v->lamps = solution_finds_lamps(&v->options, v->scene);
	v->buffers = v->factors->buffers;
	v->stage = count > 0 ? SOLUTION_SURFACES : SOLUTION_DONE;
	enum status s = v->imported ? imported_check(&plan->imported, &v->factors->elements, err) : STATUS_OK;
	if (s == STATUS_OK)
		s = make_arrays(v, err);
	if (s == STATUS_OK && count > 0)
		s = buffer_init(&v->buffers.surfaces, v->device, count * sizeof *v->made_of, BUFFER_DEVICE, err);
	if (s == STATUS_OK && count > 0)
		s = make_passes(v, gl, plan, err);
	return s;
}
