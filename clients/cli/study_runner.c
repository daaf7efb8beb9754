// One run of a study: its image put in place, its line written.
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/interrupt.h"
#include "clients/cli/quote.h"
#include "clients/cli/report.h"
#include "clients/cli/study.h"

// A point that failed so often in a session is left alone.
#define FAILURES_MAX 3u
// A run is made so often at most until it is warm, primed and has not waited for others.
#define TRIES_MAX 3u
// Behind other clients of the daemon a run waited too long for its time to count: so many seconds, and this share of it.
#define WAIT_S 0.02
#define WAIT_SHARE 0.2

// A render that is under way, and what came of it.
struct taken {
	struct study *study;
	struct job *job;
	const struct study_run *run;
	struct candil_accepted accepted;
	struct candil_done done;
	struct candil_image image; // its `data` is ours to free
};

// ---- the run ---------------------------------------------------------------------------------------------------------

static bool take_event(void *user, const struct candil_event *event)
{
	struct taken *taken = user;
	switch (event->kind) {
	case CANDIL_EVENT_ACCEPTED:
		job_take_accepted(taken->job, &event->u.accepted);
		taken->accepted = event->u.accepted;
		return true;
	case CANDIL_EVENT_PROGRESS:
		taken->study->fraction = event->u.progress.fraction;
		study_say_progress(taken->study, taken->run);
		return true;
	case CANDIL_EVENT_IMAGE:
		if (event->u.image.final) {
			candil_keep_image(taken->job->target.client, &event->u.image);
			taken->image = event->u.image;
		}
		return true;
	case CANDIL_EVENT_DONE:
		taken->done = event->u.done;
		return true;
	default:
		return true;
	}
}

static bool take_quote(void *user, const struct candil_event *event)
{
	json_t **quote = user;
	if (event->kind == CANDIL_EVENT_QUOTE)
		*quote = quote_json(&event->u.quote);
	return true;
}

// Ask what a point's runs will take before the first of them is made, cold or not, to see later whether that was so. The
// answer is kept under the id of the run that it goes to. No quote is no failure of the run.
static void ask_quote(struct study *study, const struct study_run *run)
{
	struct candil_option options[STUDY_SETTINGS_MAX];
	struct candil_error error;
	struct study_run first = *run;
	json_t *quote = NULL;
	uint32_t id;
	if (run->kind == STUDY_COLD)
		study_make_run(study, study->plan.points[run->point].kind, run->view, run->point, 1, &first);
	if ((run->kind != STUDY_COLD && run->kind != STUDY_REFERENCE && run->seed != 1) ||
	    json_object_get(study->quotes, first.id))
		return;
	study_request(study, &first, options);
	if (candil_submit_quote(study->job.target.client, &study->job.options.request, 0, &id, &error) == CANDIL_STATUS_OK)
		job_await(&study->job, id, take_quote, &quote, &error);
	json_object_set_new(study->quotes, first.id, quote ? quote : json_null());
}

// The line of a run, without what came of it.
static json_t *begin_line(const struct study *study, const struct study_run *run)
{
	char command[8192];
	const struct study_point *p = study_point_of(study, run);
	const struct candil_render_request *r = &study->job.options.request;
	json_t *settings =
	    p ? study_settings_json(p->samples, p->settings, p->setting_count)
	      : study_settings_json(r->samples, study->plan.reference_settings, study->plan.reference_setting_count);
	const char *base = study->texts.effects[0] ? study->texts.effects : "auto";
	const char *effects = p && p->effects[0] ? p->effects : base;
	const bool whole = study_command_line(study, run, command, sizeof(command));
	json_t *quote = json_object_get(study->quotes, run->id);
	return json_pack("{s:s,s:s,s:o,s:s,s:o,s:s,s:o,s:o,s:O}", "id", run->id, "kind", study_kind_name(run->kind), "view",
			 cli_json_u64(run->view), "technique", technique_name((unsigned)r->technique), "settings", settings,
			 "effects", effects, "seed", cli_json_u64(run->seed), "command",
			 whole ? cli_json_text(command) : json_null(), "quote", quote ? quote : json_null());
}

static enum exit_code write_failure(struct study *study, struct study_run *run, const struct candil_error *error)
{
	json_t *line = begin_line(study, run);
	json_t *failed = json_pack("{s:i,s:s,s:o}", "code", (int)error->code, "name", candil_status_name(error->code),
				   "message", cli_json_text(error->text));
	json_object_set_new(line, "failed", failed);
	run->failed = true;
	snprintf(run->why, sizeof(run->why), "%s", error->text);
	if (run->kind != STUDY_REFERENCE) {
		struct study_point *p = &study->plan.points[run->point];
		// The worker may be lost by bad luck. What it refused it will refuse again.
		p->failures += error->code == CANDIL_STATUS_WORKER_LOST ? 1 : FAILURES_MAX;
		snprintf(p->why, sizeof(p->why), "%s", error->text);
	}
	return study_append(study, run->id, line);
}

static enum exit_code write_good(struct study *study, struct study_run *run, struct taken *taken)
{
	struct render_options *o = &study->job.options;
	const char *before = o->output;
	char name[STUDY_ID + 16];
	snprintf(name, sizeof(name), "images/%s.exr", run->id);
	if (!study_save(study, study->images, name + strlen("images/"), taken->image.data, taken->image.bytes))
		return job_fail_output(&study->job, name);
	o->output = name;
	const struct report report = {
	    .options = o,
	    .scene = &study->job.target.info,
	    .camera = study_choose_camera(study, &study->plan.views[run->view], &o->request),
	    .accepted = taken->accepted,
	    .done = taken->done,
	    .bytes = taken->image.bytes,
	    .made_width = taken->image.made_width,
	    .made_height = taken->image.made_height,
	    .images = 1,
	};
	json_t *line = begin_line(study, run);
	json_object_set_new(line, "warm", json_boolean(taken->done.cold_us == 0));
	json_object_set_new(line, "image", json_string(name));
	json_object_set_new(line, "report", report_json(&report));
	json_object_set_new(line, "failed", json_null());
	o->output = before;
	run->done = true;
	run->failed = false;
	return study_append(study, run->id, line);
}

// Ask for a run and wait for it. *status: how the run itself ended.
static enum exit_code ask(struct study *study, const struct study_run *run, struct taken *taken, candil_status *status,
			  struct candil_error *error)
{
	struct candil_option options[STUDY_SETTINGS_MAX];
	uint32_t id;
	*taken = (struct taken){.study = study, .job = &study->job, .run = run};
	study_request(study, run, options);
	study->made++;
	study->fraction = 0;
	study->now = run;
	*status = candil_submit_render(study->job.target.client, &study->job.options.request, &id, error);
	if (*status == CANDIL_STATUS_OK)
		*status = job_await(&study->job, id, take_event, taken, error);
	study->now = NULL;
	if (*status == CANDIL_STATUS_OK && !study->device[0])
		snprintf(study->device, sizeof(study->device), "%s", taken->done.device);
	// The connection is over, or somebody wants it to be.
	if (interrupt_seen() || *status == CANDIL_STATUS_CANCELLED)
		return job_fail_between(&study->job);
	const enum exit_code code = *status == CANDIL_STATUS_OK ? EXIT_DONE : cli_exit_code(*status);
	return code == EXIT_CONNECT ? job_fail(&study->job, error) : EXIT_DONE;
}

static void add_time(struct study *study, const struct study_run *run, double seconds)
{
	struct study_times *times;
	if (run->kind == STUDY_REFERENCE)
		return;
	times = &study->plan.points[run->point].times[run->view];
	times->seconds += seconds;
	times->runs++;
}

// Whether the runs before have left what the scene keeps for this point: nothing without noise is timed before that.
static bool is_primed(const struct study *study, const struct study_run *run)
{
	if (run->kind == STUDY_REFERENCE || study_has_noise(study->plan.points[run->point].technique))
		return true;
	return study->has_last && study->last_view == run->view &&
	       study_is_series(&study->plan.points[study->last_point], &study->plan.points[run->point]);
}

static void set_last(struct study *study, const struct study_run *run)
{
	study->has_last = run->kind != STUDY_REFERENCE;
	study->last_point = run->point;
	study->last_view = run->view;
}

// Whether so much of a run's time was spent behind others that it says little of the run.
static bool has_waited(const struct candil_done *done)
{
	double waited = 0;
	for (uint32_t i = 0; i < done->stage_count; i++)
		if (strcmp(done->stages[i].name, "queue") == 0 || strcmp(done->stages[i].name, "wait") == 0)
			waited += (double)done->stages[i].us;
	return waited > WAIT_S * 1e6 && waited > WAIT_SHARE * (double)done->elapsed_us;
}

// Do a run once. One that compiled, that had nothing ready or that waited for others is not the one that is wanted, unless a
// cold one is: *again. On the last try such waits are taken as they are, and counted.
static enum exit_code make_once(struct study *study, struct study_run *run, bool last, bool *again)
{
	struct taken taken;
	struct candil_error error;
	candil_status status;
	enum exit_code code;
	*again = false;
	study_say_progress(study, run);
	ask_quote(study, run);
	// The run would be seen through to its end: an interrupt cancels the request alone that it comes in.
	if (interrupt_seen())
		return job_fail_between(&study->job);
	const double before = study_clock();
	const bool primed = is_primed(study, run);
	code = ask(study, run, &taken, &status, &error);
	if (code == EXIT_DONE && status != CANDIL_STATUS_OK) {
		code = write_failure(study, run, &error);
	} else if (code == EXIT_DONE) {
		const bool cold = taken.done.cold_us > 0;
		if (cold || run->kind == STUDY_COLD)
			study_learn_cold(study, (unsigned)study->job.options.request.technique,
					 (double)taken.done.elapsed_us, (double)taken.done.cold_us);
		set_last(study, run);
		const bool timed = run->kind != STUDY_REFERENCE && run->kind != STUDY_COLD,
			   waited = timed && has_waited(&taken.done);
		*again = timed && (cold || !primed || (waited && !last));
		if (!*again) {
			study->waited += waited;
			if (run->kind != STUDY_COLD)
				add_time(study, run, study_clock() - before);
			code = write_good(study, run, &taken);
		}
	}
	candil_free(taken.image.data);
	return code;
}

enum exit_code study_make(struct study *study, struct study_run *run)
{
	bool again = true;
	enum exit_code code = EXIT_DONE;
	if (run->done)
		return EXIT_DONE;
	if (run->kind != STUDY_REFERENCE && study->plan.points[run->point].failures >= FAILURES_MAX) {
		snprintf(run->why, sizeof(run->why), "%.255s", study->plan.points[run->point].why);
		return EXIT_DONE;
	}
	// Twice at most come runs that only warm up: a worker that is lost between them is cold again.
	for (unsigned i = 0; i < TRIES_MAX && again && code == EXIT_DONE; i++)
		code = make_once(study, run, i + 1 == TRIES_MAX, &again);
	if (again && code == EXIT_DONE)
		snprintf(run->why, sizeof(run->why), "it was not warm in %u tries, for the worker was lost between them",
			 TRIES_MAX);
	return code;
}
