#include "server/worker/technique/radiosity/radiosity.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#include "protocol/names.h"
#include "server/base/clock.h"
#include "server/worker/devices.h"
#include "server/worker/technique/deferred/deferred.h"
#include "server/worker/technique/radiosity/display_views.h"
#include "server/worker/technique/radiosity/imported.h"
#include "server/worker/technique/radiosity/patch_file.h"
#include "server/worker/technique/radiosity/prospect.h"
#include "server/worker/technique/radiosity/radiosity_options.h"
#include "server/worker/technique/radiosity/radiosity_plan.h"
#include "server/worker/technique/radiosity/residual.h"
#include "server/worker/technique/radiosity/survey.h"
#include "server/worker/trace/trace.h"

#define SOLVE_SHARE 0.9 // share of the job's work that making the solution counts for

struct technique_job {
	struct resident_scene *scene;
	struct gl_device *gl;
	struct plan plan;
	struct solution *solution; // held
	bool made; // some of the solution was made by this job
	double fraction; // of the solution, told so far
	struct survey *survey; // NULL: nothing of form factors is shown
	struct residual *residual; // where radiosity.show shows it
	struct patch_file *file; // NULL: a picture is made, or the file is not begun
	uint64_t survey_us, residual_us, file_us; // host time of them
	bool placed; // what is shown is on OpenGL
	struct display_field field; // of a view
	struct display display;
	struct deferred *deferred;
};

// ---- a job --------------------------------------------------------------------------------------------------------------

static void radiosity_end(struct technique_job *j)
{
	if (!j)
		return;
	deferred_destroy(j->deferred);
	display_finish(&j->display);
	display_field_finish(&j->field);
	patch_file_destroy(j->file);
	residual_destroy(j->residual);
	survey_destroy(j->survey);
	solution_release(j->solution);
	free(j);
}

static bool makes_file(const struct plan *plan)
{
	return !format_is_picture(plan->format);
}

// Begin what shows the solution.
static enum status begin_display(struct technique_job *j, struct devices *devices, struct error *err)
{
	const struct display_options display = radiosity_display_options(&j->plan, j->scene);
	const struct plan shown = display_plan(&j->plan);
	enum status s = display_init(&j->display, devices, j->scene, &j->plan, &display, &j->field, err);
	if (s == STATUS_OK)
		s = deferred_create(devices, j->scene, &shown, radiosity_settings(&j->plan)->direct.rows,
				    display_traces(&display) ? TRACE_BINDINGS : 0, j->display.passes, j->display.pass_count,
				    &j->deferred, err);
	if (s == STATUS_OK)
		deferred_add_setup(j->deferred, 0, display_compile_us(&j->display) + solution_take_compile_us(j->solution));
	return s;
}

static enum status radiosity_begin(struct devices *devices, struct resident_scene *scene, const struct plan *plan,
				   struct technique_job **job, struct error *err)
{
	struct solution_options options;
	struct technique_job *j = calloc(1, sizeof *j);
	if (!j)
		return error_set(err, STATUS_MEMORY, "out of memory");
	j->scene = scene;
	j->plan = *plan;
	radiosity_solution_options(plan, scene, &options);
	enum status s = devices_gl(devices, &j->gl, err);
	if (s == STATUS_OK)
		s = solution_acquire(scene, devices->vk, j->gl, plan, &options, &j->solution, err);
	if (s == STATUS_OK && !makes_file(plan))
		s = begin_display(j, devices, err);
	// A solution that is taken from a file has no rows to report on.
	if (s == STATUS_OK && j->display.options.plain && !imported_solution(plan))
		s = survey_create(j->solution, &j->survey, err);
	if (s == STATUS_OK)
		*job = j;
	else
		radiosity_end(j);
	return s;
}

// The element of radiosity.row, or without the option the one in the middle of the picture.
static enum status choose_row(const struct technique_job *j, uint32_t *element, struct error *err)
{
	const struct elements *e = &j->solution->factors->elements;
	const uint32_t asked = radiosity_settings(&j->plan)->row;
	if (e->count == 0)
		return error_set(err, STATUS_BAD_ARGUMENT, "the scene has no surface, and so no row to show");
	if (asked != NONE && asked >= e->count)
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "there is no element %u for radiosity.row: the scene has %u patches by these options, so "
				 "elements 0 to %u, first all fronts and then all backs",
				 asked, e->patches.count, e->count - 1);
	*element = asked != NONE
		       ? asked
		       : display_element_seen(e, &j->scene->view, &j->plan, 0.5 * j->plan.width, 0.5 * j->plan.height);
	if (*element == NONE)
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "nothing is in the middle of the picture whose row could be shown: say which, by "
				 "radiosity.row");
	return STATUS_OK;
}

// Fill in the values of radiosity.show, 3 floats for each element.
static enum status fill_view(const struct technique_job *j, float *values, struct error *err)
{
	static const enum display_view views[] = {
	    [RADIOSITY_SHOW_B] = DISPLAY_VIEW_B,           [RADIOSITY_SHOW_E] = DISPLAY_VIEW_E,
	    [RADIOSITY_SHOW_ALBEDO] = DISPLAY_VIEW_ALBEDO, [RADIOSITY_SHOW_ID] = DISPLAY_VIEW_ID,
	    [RADIOSITY_SHOW_NORMAL] = DISPLAY_VIEW_NORMAL, [RADIOSITY_SHOW_RESIDUAL] = DISPLAY_VIEW_RESIDUAL,
	    [RADIOSITY_SHOW_ROW] = DISPLAY_VIEW_ROW};
	const struct solution *v = j->solution;
	const uint32_t show = radiosity_settings(&j->plan)->show;
	struct display_source source = {
	    .elements = &v->factors->elements, .surfaces = v->made_of, .irradiance = v->irradiance};
	uint32_t *columns = NULL, element;
	float *factors = NULL;
	enum status s = STATUS_OK;
	if (j->residual)
		source.residual = residual_values(j->residual);
	if (show == RADIOSITY_SHOW_ROW) {
		s = choose_row(j, &element, err);
		if (s == STATUS_OK && v->reached[element])
			s = factors_read_row(solution_matrix(v), element, &columns, &factors, err);
		if (s != STATUS_OK)
			return s;
		source.columns = columns;
		source.factors = factors;
		source.entries = columns ? solution_matrix(v)->rows[element].count : 0;
	}
	display_view_fill(views[show], &source, values);
	free(columns);
	free(factors);
	return STATUS_OK;
}

// Bring what is shown to OpenGL: light is there if another picture of the solution was made.
static enum status place_field(struct technique_job *j, struct error *err)
{
	const struct elements *e = &j->solution->factors->elements;
	enum status s;
	if (j->display.options.plain) {
		float *values = malloc(3 * sizeof *values * e->count + 1);
		s = values ? fill_view(j, values, err) : error_set(err, STATUS_MEMORY, "out of memory");
		if (s == STATUS_OK && e->count > 0)
			s = display_field_init(&j->field, j->gl, e, values, false, err);
		free(values);
	} else {
		s = solution_field(j->solution, j->gl, j->display.options.corners, &j->display.field, err);
	}
	j->placed = s == STATUS_OK;
	return s;
}

static enum status step_survey(struct technique_job *j, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	const enum status s = survey_step(j->survey, budget_us, err);
	j->survey_us += clock_us() - start;
	return s;
}

// Of all the job's work, by the share of the picture that is done. A solution that was there is none of it.
static double fraction_of(const struct technique_job *j, double shown)
{
	return j->made ? SOLVE_SHARE + (1 - SOLVE_SHARE) * shown : shown;
}

static bool lacks_residual(const struct technique_job *j)
{
	return radiosity_settings(&j->plan)->show == RADIOSITY_SHOW_RESIDUAL && !makes_file(&j->plan) &&
	       !(j->residual && residual_finished(j->residual));
}

static enum status step_residual(struct technique_job *j, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	enum status s = j->residual ? STATUS_OK : residual_create(j->solution, &j->residual, err);
	if (s == STATUS_OK)
		s = residual_step(j->residual, budget_us, err);
	j->residual_us += clock_us() - start;
	return s;
}

static enum status step_file(struct technique_job *j, uint32_t budget_us, struct step_result *result, struct error *err)
{
	const uint64_t start = clock_us();
	enum status s = STATUS_OK;
	if (!j->file)
		s = patch_file_create(j->solution, j->scene, j->plan.format, LIMIT_PATCH_FILE_BYTES, &j->file, err);
	if (s == STATUS_OK)
		s = patch_file_step(j->file, budget_us, err);
	j->file_us += clock_us() - start;
	if (s != STATUS_OK)
		return s;
	result->fraction = fraction_of(j, patch_file_fraction(j->file));
	result->finished = patch_file_finished(j->file);
	result->samples_done = result->finished ? j->plan.samples : 0;
	return STATUS_OK;
}

static enum status radiosity_step(struct technique_job *j, uint32_t budget_us, struct step_result *result, struct error *err)
{
	enum status s = STATUS_OK;
	if (!solution_finished(j->solution)) {
		j->made = true;
		s = solution_step(j->solution, budget_us, err);
		// The more is seen, the more rows turn out to be wanted, and the share that is made may fall.
		j->fraction = fmax(j->fraction, solution_fraction(j->solution));
		result->fraction = SOLVE_SHARE * j->fraction;
		return s;
	}
	result->fraction = fraction_of(j, 0);
	if (j->survey && !survey_finished(j->survey))
		return step_survey(j, budget_us, err);
	if (lacks_residual(j))
		return step_residual(j, budget_us, err);
	if (makes_file(&j->plan))
		return step_file(j, budget_us, result, err);
	if (!j->placed)
		return place_field(j, err);
	if (!display_ready(&j->display))
		return display_step(&j->display, deferred_timer(j->deferred), budget_us, err);
	s = deferred_step(j->deferred, budget_us, result, err);
	result->fraction = fraction_of(j, result->fraction);
	return s;
}

static enum status read_file(struct technique_job *j, struct frame **frame, struct error *err)
{
	int fd;
	uint64_t bytes;
	enum status s = j->file ? patch_file_take(j->file, &fd, &bytes, err)
				: error_set(err, STATUS_INTERNAL, "there is no file to read");
	if (s != STATUS_OK)
		return s;
	s = frame_create_file(j->plan.width, j->plan.height, fd, bytes, frame, err);
	if (s != STATUS_OK) {
		close(fd);
		return s;
	}
	(*frame)->samples = j->plan.samples;
	frame_add_stage(*frame, FRAME_STAGE_COMPILE, solution_take_compile_us(j->solution));
	frame_add_stage(*frame, "write", j->file_us);
	return STATUS_OK;
}

static enum status radiosity_read(struct technique_job *j, struct frame **frame, struct error *err)
{
	const bool file = makes_file(&j->plan);
	const enum status s = file ? read_file(j, frame, err) : deferred_read(j->deferred, frame, err);
	if (s != STATUS_OK)
		return s;
	(*frame)->diagram = !file && j->display.options.plain;
	if (solution_finished(j->solution))
		solution_account(j->solution, j->made, *frame);
	if (solution_finished(j->solution))
		radiosity_work(j->solution, j->scene, &j->plan, j->made, &(*frame)->work);
	if (j->survey_us > 0)
		frame_add_stage(*frame, "check", j->survey_us);
	if (j->residual_us > 0)
		frame_add_stage(*frame, "residual", j->residual_us);
	if (j->display.options.plain)
		survey_account(j->solution, *frame);
	if (j->residual)
		frame_add_figure(*frame, "residual.most", residual_most(j->residual), "W/m²");
	return STATUS_OK;
}

#define RADIOSITY_EFFECTS \
	(1u << candil_Effect_EFFECT_TEXTURES | 1u << candil_Effect_EFFECT_EMITTERS | 1u << candil_Effect_EFFECT_LIGHTS | \
	 1u << candil_Effect_EFFECT_ENVIRONMENT | 1u << candil_Effect_EFFECT_BOUNCES | 1u << candil_Effect_EFFECT_GLOSSY | \
	 1u << candil_Effect_EFFECT_ALPHA_MASK | 1u << candil_Effect_EFFECT_VERTEX_COLORS | \
	 1u << candil_Effect_EFFECT_UNLIT)

const struct technique technique_radiosity = {.number = candil_Technique_TECHNIQUE_RADIOSITY,
					      .options = radiosity_options,
					      .needs = radiosity_needs,
					      .defaults = radiosity_options_default,
					      .check = radiosity_options_check,
					      .depth = radiosity_depth,
					      .effects = RADIOSITY_EFFECTS,
					      .files = 1u << candil_Format_FORMAT_PLY | 1u << candil_Format_FORMAT_MTX,
					      .cannot = radiosity_cannot,
					      .simulates = radiosity_simulates,
					      .sides_are_code = true,
					      .notes = radiosity_notes,
					      .bytes = radiosity_bytes,
					      .advise = radiosity_advise,
					      .foresee = radiosity_foresee,
					      .begin = radiosity_begin,
					      .step = radiosity_step,
					      .read = radiosity_read,
					      .end = radiosity_end};
