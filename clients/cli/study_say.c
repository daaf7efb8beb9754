// What `candil study` says: the plan, how far it is, and how it ended.
#include <inttypes.h>
#include <limits.h>
#include <string.h>

#include "clients/cli/study.h"

#define SAY_EVERY_S 10.0 // where standard error is no terminal
#define MISSING_LINES 8u
#define BAR 20u

// Settings as a person reads them: "vct.resolution 64, auto,-glossy".
static void describe(const struct study_point *point, char *text, size_t capacity)
{
	size_t used = 0;
	text[0] = '\0';
	for (uint32_t i = 0; i < point->setting_count && used < capacity; i++)
		used += (size_t)snprintf(text + used, capacity - used, "%s%s %s", i > 0 ? ", " : "", point->settings[i].name,
					 point->settings[i].value);
	if (point->effects[0] && used < capacity)
		used += (size_t)snprintf(text + used, capacity - used, "%s%s", used > 0 ? ", " : "", point->effects);
	if (used == 0)
		snprintf(text, capacity, "its defaults");
}

// A line of the table: the points from `at` on that differ in their samples alone. Returns the next point.
static uint32_t say_points(const struct study *study, uint32_t at)
{
	const struct study_plan *plan = &study->plan;
	char what[256], samples[128];
	size_t used = 0;
	double seconds = 0;
	uint32_t runs = 0, end = at;
	describe(&plan->points[at], what, sizeof(what));
	for (; end < plan->point_count && study_is_series(&plan->points[at], &plan->points[end]); end++) {
		const struct study_point *p = &plan->points[end];
		runs += study_seeds_of(plan, p) * plan->view_count;
		for (uint32_t v = 0; v < plan->view_count; v++)
			seconds += study_seeds_of(plan, p) * study_predict(study, end, v);
		if (used < sizeof(samples))
			used += (size_t)snprintf(samples + used, sizeof(samples) - used, "%s%" PRIu32, end > at ? ", " : "",
						 p->samples);
	}
	printf("  %-10s %-34.60s %-24s %4" PRIu32 "  %8.1f s\n", technique_name(plan->points[at].technique), what, samples,
	       runs, seconds);
	return end;
}

void study_say_plan(struct study *study)
{
	const struct study_plan *plan = &study->plan;
	progress_clear(&study->job.progress);
	if (study->job.options.quiet || study->job.cli->json || study_left(study) == 0)
		return;
	printf("plan       %" PRIu32 "x%" PRIu32 ", %" PRIu32 " view%s, %" PRIu32 " runs\n", plan->width, plan->height,
	       plan->view_count, cli_s(plan->view_count), study->run_count);
	printf("  %-10s %-34s %-24s %4s  %10s\n", "technique", "settings", "samples", "runs", "about");
	for (uint32_t v = 0; plan->reference && v < plan->view_count; v++) {
		char target[64], most[32];
		snprintf(target, sizeof(target), "reference, relMSE to %.2g", plan->views[v].relmse);
		snprintf(most, sizeof(most), "at most %" PRIu32, plan->views[v].samples);
		printf("  %-10s %-34s %-24s %4u  %8.1f s\n",
		       technique_name((unsigned)technique_with(TECHNIQUE_RENDERS | TECHNIQUE_NOISE)), target, most, 1u,
		       study_predict_reference(study, v));
	}
	for (uint32_t at = 0; at < plan->point_count;)
		at = say_points(study, at);
	printf("           about %.0f s are left, of a budget of %.0f s\n", study_left(study), plan->budget_s);
	fflush(stdout);
}

static void name_run(const struct study *study, const struct study_run *run, char *text, size_t capacity)
{
	char what[256];
	if (run->kind == STUDY_REFERENCE) {
		snprintf(text, capacity, "the reference");
		return;
	}
	const struct study_point *p = &study->plan.points[run->point];
	describe(p, what, sizeof(what));
	snprintf(text, capacity, "%s, %.60s, %" PRIu32 " sample%s%s", technique_name(p->technique), what, p->samples,
		 cli_s(p->samples), run->kind == STUDY_COLD ? ", cold" : "");
}

void study_say_progress(struct study *study, const struct study_run *run)
{
	char line[256], what[128], part[16] = "", bar[BAR + 1];
	uint32_t done = 0;
	const double now = study_clock();
	if (study->job.options.quiet || (!study->job.progress.shown && now - study->said < SAY_EVERY_S))
		return;
	study->said = now;
	name_run(study, run, what, sizeof(what));
	if (study->now == run)
		snprintf(part, sizeof(part), ", %.0f %%", 100 * study->fraction);
	for (uint32_t i = 0; i < study->run_count; i++)
		done += study->runs[i].done;
	if (study->run_count == 0)
		snprintf(line, sizeof(line), "measuring the scene: %s%s", what, part);
	else {
		const uint32_t filled = done * BAR / study->run_count;
		memset(bar, '.', BAR);
		memset(bar, '#', filled);
		bar[BAR] = '\0';
		snprintf(line, sizeof(line), "[%s] %" PRIu32 "/%" PRIu32 " runs, about %.0f s left: %s%s", bar, done,
			 study->run_count, study_left(study), what, part);
	}
	if (study->job.progress.shown)
		progress_say(&study->job.progress, line);
	else
		fprintf(stderr, "%s\n", line);
}

static void say_missing(const json_t *missing)
{
	size_t i = 0;
	for (; i < json_array_size(missing) && i < MISSING_LINES; i++) {
		const json_t *one = json_array_get(missing, i);
		printf("missing    %s: %s\n", json_string_value(json_object_get(one, "run")),
		       json_string_value(json_object_get(one, "why")));
	}
	if (i < json_array_size(missing))
		printf("missing    %zu more\n", json_array_size(missing) - i);
}

enum exit_code study_say_end(struct study *study)
{
	char report[PATH_MAX];
	json_t *missing = study_missing_json(study);
	const bool complete = json_array_size(missing) == 0;
	const enum exit_code code = complete && !study->report_why[0] ? EXIT_DONE : EXIT_OTHER;
	const double seconds = study_clock() - study->started;
	progress_clear(&study->job.progress);
	job_end(&study->job);
	if (!study_path(study, "report.html", report, sizeof(report)))
		report[0] = '\0';
	if (study->job.cli->json) {
		json_t *answer =
		    json_pack("{s:o,s:o,s:b,s:o,s:o,s:o,s:o,s:o,s:f}", "folder", cli_json_text(study->folder), "report",
			      study->report_made ? cli_json_text(report) : json_null(), "complete", complete, "missing",
			      missing, "skipped", study_skipped_json(study), "runs", cli_json_u64(study->run_count), "made",
			      cli_json_u64(study->made), "why",
			      study->report_why[0] ? cli_json_text(study->report_why) : json_null(), "seconds", seconds);
		job_put_warnings(&study->job, answer);
		return cli_print_json(answer, stdout, code);
	}
	say_missing(missing);
	json_decref(missing);
	if (study->report_why[0])
		fprintf(stderr, "candil: there is no report: %s\n", study->report_why);
	if (study->job.options.quiet)
		return code;
	for (uint32_t i = 0; i < study->note_count; i++)
		printf("note       %s\n", study->notes[i]);
	printf("study      %" PRIu32 " runs, %" PRIu32 " made now in %.1f s; %s\n", study->run_count, study->made, seconds,
	       complete ? "complete" : "start it again for what is missing");
	if (study->report_made)
		printf("open       %s\n", report);
	return cli_flush(stdout, code);
}
