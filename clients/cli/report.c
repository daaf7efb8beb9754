#include "clients/cli/report.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "clients/cli/quote.h"
#include "protocol/names.h"

static bool is_simulated(const struct candil_effect_report *effect)
{
	return effect->state == CANDIL_EFFECT_SIMULATED || effect->state == CANDIL_EFFECT_FORCED;
}

static void print_effects(const struct candil_accepted *accepted, bool simulated, FILE *stream)
{
	const char *separator = simulated ? "simulated  " : "left out   ";
	for (uint32_t i = 0; i < accepted->plan_count; i++) {
		const struct candil_effect_report *e = &accepted->plan[i];
		if (is_simulated(e) != simulated)
			continue;
		fprintf(stream, "%s%s", separator, candil_effect_name(e->effect));
		if (e->state == CANDIL_EFFECT_FORCED)
			fputs(" (forced)", stream);
		if (e->state == CANDIL_EFFECT_SWITCHED_OFF)
			fputs(" (switched off)", stream);
		if (e->why[0])
			fprintf(stream, ": %s", e->why);
		if (e->timed)
			fprintf(stream, " (%s%.1f ms, %.1f %%)", simulated ? "" : "would add ", (double)e->cost_us * 1e-3,
				100 * e->share);
		separator = "; ";
	}
	if (separator[0] == ';')
		fputc('\n', stream);
}

void report_print_stages(const struct candil_done *done, FILE *stream)
{
	fprintf(stream, "time       %.1f ms", (double)done->elapsed_us * 1e-3);
	if (done->cold_us > 0)
		fprintf(stream, " (%.1f warm)", (double)(done->elapsed_us - done->cold_us) * 1e-3);
	for (uint32_t i = 0; i < done->stage_count; i++)
		fprintf(stream, "%s%s %.1f", i == 0 ? ": " : ", ", done->stages[i].name, (double)done->stages[i].us * 1e-3);
	fputc('\n', stream);
}

// Print how much light a clamp removed, if there was one.
static void print_clamp(const struct candil_done *done, FILE *stream)
{
	for (uint32_t i = 0; i < done->figure_count; i++)
		if (strcmp(done->figures[i].name, "clamp.share") == 0)
			fprintf(stream, "clamped    %.2g %% of the light, which the picture lacks\n",
				100 * done->figures[i].value);
}

void report_print_error(const struct candil_done *done, FILE *stream)
{
	const double e = done->estimated_relmse, low = done->relmse_low, high = done->relmse_high;
	const char *kind = candil_error_kind_name(done->error_kind);
	if (done->error_kind == CANDIL_ERROR_KIND_UNKNOWN)
		fprintf(stream, "error      %s\n", kind);
	else if (e == 0 && done->error_kind == CANDIL_ERROR_KIND_MEASURED)
		fputs("error      none: every sample says the same\n", stream);
	else if (high >= 0)
		fprintf(stream, "error      relative MSE about %.2e (%.2e … %.2e, 90 %%), %s\n", e, low, high, kind);
	else
		fprintf(stream,
			"error      relative MSE %.2e or more (at least %.2e, 90 %%), %s: light may not have been found\n",
			e, low, kind);
}

// What technique auto chose by, beside what came out above.
static void print_quote(const struct candil_quote *quote, FILE *stream)
{
	const struct candil_choice *c = &quote->choice;
	fprintf(stream, "chosen     %s\npredicted  %.1f ms (%.1f … %.1f), relative MSE %.2e (%.2e … %.2e), 90 %%, by %s\n",
		quote->why, c->time_ms, c->time_ms_low, c->time_ms_high, c->relmse, c->relmse_low, c->relmse_high,
		quote->from);
}

json_t *report_verdict_json(const struct candil_verdict *verdict)
{
	return json_pack("{s:f,s:f,s:f}", "black", verdict->black, "clipped", verdict->clipped, "missed", verdict->missed);
}

void report_print(const struct report *r, FILE *stream)
{
	const struct candil_render_request *request = &r->options->request;
	const struct candil_done *done = &r->done;
	const bool picture = format_is_picture((unsigned)request->format);
	if (picture)
		fprintf(stream, "image      %s, %" PRIu32 "x%" PRIu32 ", %s, %" PRIu64 " bytes\n", r->options->output,
			request->width, request->height, candil_format_name(request->format), r->bytes);
	else
		fprintf(stream, "file       %s, %s, %" PRIu64 " bytes\n", r->options->output,
			candil_format_name(request->format), r->bytes);
	if (r->made_width != request->width || r->made_height != request->height)
		fprintf(stream, "made of    %" PRIu32 "x%" PRIu32 " pixels, scaled: --time left none for more\n",
			r->made_width, r->made_height);
	char depth[16] = "unbounded";
	if (r->accepted.depth != DEPTH_UNBOUNDED)
		snprintf(depth, sizeof(depth), "%" PRIu32, r->accepted.depth);
	fprintf(stream, "technique  %s, %" PRIu32 " sample%s, depth %s, on %s\n",
		candil_technique_name(r->accepted.technique), done->samples, cli_s(done->samples), depth,
		done->device[0] ? done->device : r->accepted.device);
	report_print_stages(done, stream);
	print_effects(&r->accepted, true, stream);
	print_effects(&r->accepted, false, stream);
	report_print_error(done, stream);
	if (r->accepted.has_quote)
		print_quote(&r->accepted.quote, stream);
	if (strcmp(done->reason, "error") == 0)
		fprintf(stream, "ended      at the target error, after %" PRIu32 " sample%s\n", done->samples,
			cli_s(done->samples));
	if (strcmp(done->reason, "time") == 0)
		fprintf(stream, "ended      at the deadline, after %" PRIu32 " sample%s\n", done->samples,
			cli_s(done->samples));
	if (picture)
		fprintf(stream, "verdict    %.3g %% of the pixels black, %.3g %% clipped, %.3g %% see no surface\n",
			100 * done->verdict.black, 100 * done->verdict.clipped, 100 * done->verdict.missed);
	print_clamp(done, stream);
	if (done->non_finite_samples > 0)
		fprintf(stream, "mended     %" PRIu64 " sample%s not finite, counted as zero\n", done->non_finite_samples,
			cli_s(done->non_finite_samples));
	if (done->retries > 0)
		fprintf(stream, "retries    %" PRIu32 ": the worker was lost and the job begun again\n", done->retries);
	if (strcmp(r->camera, "framed") == 0)
		fprintf(stream,
			"camera     the scene has none: its bounds are framed (--camera "
			"%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,0,1,0,%g)\n",
			request->eye.x, request->eye.y, request->eye.z, request->target.x, request->target.y,
			request->target.z, request->vfov_degrees);
	for (uint32_t i = 0; i < r->accepted.note_count; i++)
		fprintf(stream, "note       %s\n", r->accepted.notes[i]);
	for (uint32_t i = 0; i < done->note_count; i++)
		fprintf(stream, "note       %s\n", done->notes[i]);
}

// The camera of the scene that was used; NULL: the list that the daemon sent does not reach to it.
static const struct candil_camera_info *find_camera(const struct report *r)
{
	const char *name = r->options->request.camera_name;
	for (uint32_t i = 0; i < r->scene->camera_list_count; i++) {
		if (!name || strcmp(r->scene->cameras[i].name, name) == 0)
			return &r->scene->cameras[i];
	}
	return NULL;
}

static void put_scene_camera(json_t *object, const struct report *r)
{
	const struct candil_camera_info *camera = find_camera(r);
	if (!camera && r->options->request.camera_name)
		json_object_set_new(object, "name", cli_json_text(r->options->request.camera_name));
	if (!camera)
		return;
	json_object_set_new(object, "name", cli_json_text(camera->name));
	const struct candil_edits *edits = r->options->request.edits;
	if (edits && (edits->node_count > 0 || edits->animation))
		return; // the edit may have moved it
	json_object_set_new(object, "eye", cli_json_vec3(&camera->eye));
	json_object_set_new(object, "target", cli_json_vec3(&camera->target));
	json_object_set_new(object, "up", cli_json_vec3(&camera->up));
	json_object_set_new(object, "vfov_degrees", json_real(camera->vfov_degrees));
}

static json_t *report_camera_json(const struct report *r)
{
	const struct candil_render_request *request = &r->options->request;
	json_t *camera = json_pack("{s:s}", "source", r->camera);
	if (!request->has_camera) {
		put_scene_camera(camera, r);
	} else {
		json_object_set_new(camera, "eye", cli_json_vec3(&request->eye));
		json_object_set_new(camera, "target", cli_json_vec3(&request->target));
		json_object_set_new(camera, "up", cli_json_vec3(&request->up));
		json_object_set_new(camera, "vfov_degrees", json_real(request->vfov_degrees));
	}
	return camera;
}

static json_t *effects_json(const struct candil_accepted *accepted)
{
	json_t *effects = json_array();
	for (uint32_t i = 0; i < accepted->plan_count; i++) {
		const struct candil_effect_report *e = &accepted->plan[i];
		json_t *effect = json_pack("{s:s,s:s,s:o}", "name", candil_effect_name(e->effect), "state",
					   candil_effect_state_name(e->state), "why", cli_json_text(e->why));
		if (e->timed) {
			json_object_set_new(effect, "cost_us", json_integer(e->cost_us));
			json_object_set_new(effect, "share", json_real(e->share));
		}
		json_array_append_new(effects, effect);
	}
	return effects;
}

json_t *report_stages_json(const struct candil_done *done)
{
	json_t *stages = json_array();
	for (uint32_t i = 0; i < done->stage_count; i++)
		json_array_append_new(stages, json_pack("{s:o,s:o}", "name", cli_json_text(done->stages[i].name), "us",
							cli_json_u64(done->stages[i].us)));
	return stages;
}

json_t *report_figures_json(const struct candil_done *done)
{
	json_t *figures = json_array();
	for (uint32_t i = 0; i < done->figure_count; i++) {
		const struct candil_figure *f = &done->figures[i];
		const bool whole = fabs(f->value) < 0x1p53 && f->value == floor(f->value);
		json_array_append_new(figures, json_pack("{s:o,s:o,s:o}", "name", cli_json_text(f->name), "value",
							 whole ? json_integer((json_int_t)f->value) : json_real(f->value),
							 "unit", cli_json_text(f->unit)));
	}
	return figures;
}

static void put_number(json_t *object, const char *key, uint64_t value)
{
	json_object_set_new(object, key, cli_json_u64(value));
}

static void put_text(json_t *object, const char *key, const char *value)
{
	json_object_set_new(object, key, cli_json_text(value));
}

// A number that is negative where it is not known.
static void put_known(json_t *object, const char *key, double value)
{
	json_object_set_new(object, key, value >= 0 ? json_real(value) : json_null());
}

void report_put_error(json_t *object, const struct candil_done *done)
{
	put_known(object, "estimated_relmse", done->estimated_relmse);
	put_known(object, "relmse_low", done->relmse_low);
	put_known(object, "relmse_high", done->relmse_high);
	put_text(object, "error_kind", candil_error_kind_name(done->error_kind));
}

json_t *report_json(const struct report *r)
{
	const struct candil_render_request *request = &r->options->request;
	const struct candil_done *done = &r->done;
	json_t *o = json_object();
	put_text(o, "image", r->options->output);
	put_text(o, "format", candil_format_name(request->format));
	put_number(o, "width", request->width);
	put_number(o, "height", request->height);
	put_number(o, "made_width", r->made_width);
	put_number(o, "made_height", r->made_height);
	put_number(o, "bytes", r->bytes);
	put_number(o, "images", r->images);
	put_number(o, "samples", done->samples);
	put_number(o, "first_sample", request->first_sample);
	put_number(o, "seed", request->seed);
	put_text(o, "scene", r->options->scene);
	put_text(o, "scene_hash", r->scene->hash);
	json_object_set_new(o, "camera", report_camera_json(r));
	put_text(o, "technique", candil_technique_name(r->accepted.technique));
	put_number(o, "depth", r->accepted.depth);
	put_text(o, "device", done->device[0] ? done->device : r->accepted.device);
	put_number(o, "job_bytes", r->accepted.job_bytes);
	json_object_set_new(o, "effects", effects_json(&r->accepted));
	json_t *notes = json_array();
	for (uint32_t i = 0; i < r->accepted.note_count; i++)
		json_array_append_new(notes, cli_json_text(r->accepted.notes[i]));
	for (uint32_t i = 0; i < done->note_count; i++)
		json_array_append_new(notes, cli_json_text(done->notes[i]));
	json_object_set_new(o, "notes", notes);
	json_object_set_new(o, "default_light", json_boolean(r->accepted.default_light));
	const bool picture = format_is_picture((unsigned)request->format);
	json_object_set_new(o, "verdict", picture ? report_verdict_json(&done->verdict) : json_null());
	json_object_set_new(o, "stages", report_stages_json(done));
	json_object_set_new(o, "figures", report_figures_json(done));
	put_number(o, "elapsed_us", done->elapsed_us);
	put_number(o, "cold_us", done->cold_us);
	report_put_error(o, done);
	put_number(o, "non_finite_samples", done->non_finite_samples);
	put_number(o, "rays", done->rays);
	put_number(o, "slices", done->slices);
	put_number(o, "retries", done->retries);
	put_text(o, "reason", done->reason);
	json_object_set_new(o, "quote", r->accepted.has_quote ? quote_json(&r->accepted.quote) : json_null());
	return o;
}
