// What a run asks for: as a request, and as the command line that asks the same.
#include <inttypes.h>
#include <string.h>

#include "clients/cli/render_values.h"
#include "clients/cli/study.h"
#include "clients/cli/view.h"

// ---- the request -----------------------------------------------------------------------------------------------------

const struct study_point *study_point_of(const struct study *study, const struct study_run *run)
{
	return run->kind == STUDY_REFERENCE ? NULL : &study->plan.points[run->point];
}

// Choose the camera. Returns its word in a report.
const char *study_choose_camera(const struct study *study, const struct study_view *view,
				struct candil_render_request *request)
{
	request->has_camera = false;
	request->camera_name = NULL;
	if (view->camera[0] && value_camera(view->camera, request))
		return request->has_camera ? "given" : "scene";
	if (study->job.target.info.camera_count > 0)
		return "scene";
	view_frame_bounds(&study->job.target.info, request);
	return "framed";
}

void study_request(struct study *study, const struct study_run *run, struct candil_option options[STUDY_SETTINGS_MAX])
{
	static bool begun; // the command line's own effects, which those of a point take the place of
	static uint32_t effects_on, effects_off;
	struct candil_render_request *r = &study->job.options.request;
	const struct study_view *view = &study->plan.views[run->view];
	const struct study_point *p = study_point_of(study, run);
	if (!begun) {
		effects_on = r->effects_on;
		effects_off = r->effects_off;
		begun = true;
	}
	r->width = study->plan.width;
	r->height = study->plan.height;
	r->format = CANDIL_FORMAT_EXR_FLOAT;
	r->technique = (enum candil_technique)(p ? (int)p->technique : technique_with(TECHNIQUE_RENDERS | TECHNIQUE_NOISE));
	r->samples = p ? p->samples : view->samples;
	r->target_error = p ? 0 : view->relmse;
	r->seed = run->seed;
	r->effects_on = effects_on;
	r->effects_off = effects_off;
	r->options = options;
	const struct study_setting *settings = p ? p->settings : study->plan.reference_settings;
	r->option_count = p ? p->setting_count : study->plan.reference_setting_count;
	for (size_t i = 0; i < r->option_count; i++)
		options[i] = (struct candil_option){settings[i].name, settings[i].value};
	if (p && p->effects[0]) {
		char list[sizeof(p->effects)];
		const char *wrong;
		memcpy(list, p->effects, sizeof(list));
		r->effects_on = r->effects_off = 0;
		value_effects(list, r, &wrong); // study_plan.c has refused what is wrong
	}
	study_choose_camera(study, view, r);
}

// ---- the command line ------------------------------------------------------------------------------------------------

bool study_command_line(const struct study *study, const struct study_run *run, char *text, size_t capacity)
{
	const struct study_view *view = &study->plan.views[run->view];
	const struct study_point *p = study_point_of(study, run);
	const unsigned technique = p ? p->technique : (unsigned)technique_with(TECHNIQUE_RENDERS | TECHNIQUE_NOISE);
	char numbers[256], error[32] = "", setting[LIMIT_OPTION_NAME + LIMIT_OPTION_VALUE + 2];
	bool full = false;
	if (!p && view->relmse > 0)
		snprintf(error, sizeof(error), " --error %.*g", STUDY_DIGITS, view->relmse);
	snprintf(numbers, sizeof(numbers),
		 " -o %s.exr --technique %s --size %" PRIu32 "x%" PRIu32 " --spp %" PRIu32 " --seed %" PRIu64 "%s", run->id,
		 technique_name(technique), study->plan.width, study->plan.height, p ? p->samples : view->samples, run->seed,
		 error);
	snprintf(text, capacity, "candil");
	if (study->job.cli->address) {
		study_quote(text, capacity, "--connect", &full);
		study_quote(text, capacity, study->job.cli->address, &full);
	}
	study_quote(text, capacity, "render", &full);
	study_quote(text, capacity, study->job.options.scene, &full);
	if (strlen(text) + strlen(numbers) + strlen(study->texts.shared) >= capacity)
		return false;
	strcat(text, numbers);
	strcat(text, study->texts.shared);
	if (view->camera[0]) {
		study_quote(text, capacity, "--camera", &full);
		study_quote(text, capacity, view->camera, &full);
	}
	if (p && p->effects[0]) {
		study_quote(text, capacity, "--effects", &full);
		study_quote(text, capacity, p->effects, &full);
	}
	const struct study_setting *settings = p ? p->settings : study->plan.reference_settings;
	const uint32_t count = p ? p->setting_count : study->plan.reference_setting_count;
	for (uint32_t i = 0; i < count; i++) {
		snprintf(setting, sizeof(setting), "%.31s=%.31s", settings[i].name, settings[i].value);
		study_quote(text, capacity, "--set", &full);
		study_quote(text, capacity, setting, &full);
	}
	return !full;
}
