// study: what accuracy costs in time on one scene, by every technique.
#include "clients/cli/study.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "clients/cli/interrupt.h"
#include "clients/libcandil/error.h"

#define DEVICE_MS 60000L // that opening a device takes at most, a driver that is asleep or busy
#define LOOK_MS 20L

static void write_utc(char out[32])
{
	const time_t now = time(NULL);
	struct tm parts;
	gmtime_r(&now, &parts);
	strftime(out, 32, "%Y-%m-%dT%H:%M:%SZ", &parts);
}

// ---- the plan --------------------------------------------------------------------------------------------------------

// What the plan was made for: everything that it depends on.
static void make_key(const struct study *study, char key[17])
{
	json_t *plan = study_plan_json(&study->plan);
	char *text = plan ? json_dumps(plan, JSON_COMPACT) : NULL;
	const char *const parts[] = {text ? text : "",
				     study->texts.shared,
				     study->vulkan,
				     study->job.target.info.hash,
				     study->job.target.picture.hash,
				     study->server,
				     study->texts.quick ? "quick" : "full"};
	uint64_t hash = study->techniques + 64u * study->plan.ablations;
	for (size_t i = 0; i < sizeof(parts) / sizeof(*parts); i++)
		hash = study_hash(hash, parts[i]);
	free(text);
	json_decref(plan);
	snprintf(key, 17, "%016" PRIx64, hash);
}

static void add_notes(struct study *study)
{
	const struct study_plan *p = &study->plan;
	if (study->texts.quick)
		study_note(study,
			   "a quick study: %" PRIu32 "x%" PRIu32 " pixels, %" PRIu32
			   " seeds in place of 8, few settings, no "
			   "ablation of effects; without --quick there is all of it",
			   p->width, p->height, p->seeds);
	if (p->left_out > 0)
		study_note(study,
			   "%" PRIu32
			   " settings of techniques without noise are left out: they do not fit into %.0f s, which "
			   "--budget raises",
			   p->left_out, p->budget_s);
	if (!p->reference)
		study_note(study, "the plan has no reference: times are known, errors are not");
	if (p->planned_s > 1.1 * p->budget_s)
		study_note(study,
			   "the plan needs about %.0f s, more than its budget of %.0f s: fewer pixels, cameras or seeds fit",
			   p->planned_s, p->budget_s);
}

// Take the plan that the folder has, if it was made for this command, else make one.
static enum exit_code settle_plan(struct study *study)
{
	char key[17];
	enum exit_code code = EXIT_DONE;
	make_key(study, key);
	const bool known = study_read_own_plan(study, key);
	if (!known)
		code = study_fit(study);
	if (code != EXIT_DONE)
		return code;
	if (!study_list_runs(study)) {
		errno = ENOMEM;
		return cli_fail_errno(study->job.cli, "the list of runs", study->job.stream);
	}
	if (!known) {
		memcpy(study->plan.key, key, sizeof(key));
		study->plan.planned_s = study_clock() - study->started + study_left(study);
		code = study_write_plan(study);
	}
	add_notes(study);
	return code == EXIT_DONE ? study_prune(study) : code;
}

// ---- the command -----------------------------------------------------------------------------------------------------

// Learn which device the daemon renders with: times of another are no times of this study. It is told once it is open.
static enum exit_code find_device(struct study *study)
{
	static struct candil_stats stats; // large
	struct candil_error error;
	for (long waited = 0; waited < DEVICE_MS && !interrupt_seen(); waited += LOOK_MS) {
		if (candil_stats(study->job.target.client, &stats, &error) != CANDIL_STATUS_OK)
			return job_fail(&study->job, &error);
		if (stats.device[0] || stats.device_error[0])
			break;
		interrupt_pause(LOOK_MS);
	}
	if (interrupt_seen())
		return job_fail_between(&study->job);
	if (!stats.device[0]) {
		// Nothing could be rendered, and what another device has rendered is not to be touched.
		error_set(&error, CANDIL_STATUS_DEVICE, "the daemon has no device to render with: %.160s",
			  stats.device_error[0] ? stats.device_error : "it does not open");
		return job_fail(&study->job, &error);
	}
	snprintf(study->vulkan, sizeof(study->vulkan), "%s", stats.device);
	study->server = candil_server(study->job.target.client)->name;
	return EXIT_DONE;
}

static enum exit_code open_all(struct study *study)
{
	enum exit_code code = study_open_folder(study);
	if (code == EXIT_DONE)
		code = job_open(&study->job);
	if (code == EXIT_DONE)
		code = study_check_scene(study);
	return code == EXIT_DONE ? find_device(study) : code;
}

static enum exit_code make_runs(struct study *study)
{
	enum exit_code code = EXIT_DONE;
	for (uint32_t i = 0; code == EXIT_DONE && i < study->run_count; i++) {
		if (interrupt_seen())
			return job_fail_between(&study->job);
		code = study_make(study, &study->runs[i]);
	}
	return code;
}

// What of the runs is to be known, once they are made.
static void add_end_notes(struct study *study)
{
	bool cold = false, any = false;
	for (uint32_t i = 0; i < study->run_count; i++) {
		const json_t *line = json_object_get(study->lines, study->runs[i].id);
		if (study->runs[i].kind != STUDY_COLD || !study->runs[i].done)
			continue;
		any = true;
		cold |= json_integer_value(json_object_get(json_object_get(line, "report"), "cold_us")) > 0;
	}
	if (any && !cold)
		study_note(study, "no run was cold: the daemon had compiled all programs before. A new folder, and no "
				  "--connect or a daemon that has just started, tell what the first run takes");
	if (study->waited > 0)
		study_note(study,
			   "%" PRIu32 " runs waited for other clients of the daemon, also when they were made again: their "
			   "times have it in them",
			   study->waited);
}

static enum exit_code do_study(struct study *study)
{
	study->started = study_clock();
	write_utc(study->started_at);
	enum exit_code code = open_all(study);
	if (code == EXIT_DONE)
		code = settle_plan(study);
	if (code != EXIT_DONE)
		return code;
	study_say_plan(study);
	const bool idle = study->made == 0 && study_left(study) == 0 && study_is_ended(study);
	if (!idle && !study_write_state(study))
		code = job_fail_output(&study->job, "study.json");
	if (code == EXIT_DONE)
		code = make_runs(study);
	if (study->made > 0 || !idle) {
		if (code == EXIT_CANCELLED)
			snprintf(study->ended_why, sizeof(study->ended_why), "the study was interrupted");
		else if (code != EXIT_DONE)
			snprintf(study->ended_why, sizeof(study->ended_why), "an error ended the study before");
		add_end_notes(study);
		write_utc(study->ended_at);
		// What ended the study has been told: a full disk once.
		if (!study_write_state(study) && code == EXIT_DONE)
			code = job_fail_output(&study->job, "study.json");
	}
	// What was made so far can be looked at, whatever ended it; but who presses Ctrl-C wants no more of it now.
	if (code != EXIT_CANCELLED)
		study_make_report(study);
	if (code == EXIT_DONE && interrupt_seen() && !study->report_made)
		code = job_fail_between(&study->job);
	if (code == EXIT_CANCELLED)
		fputs("candil: what is done is kept; the same command goes on from there\n", stderr);
	return code == EXIT_DONE ? study_say_end(study) : code;
}

static enum exit_code run_study(struct cli *cli, const struct command *self, int argc, char **argv)
{
	// Static because it is too large for the stack; a process runs one command.
	static struct study study;
	enum exit_code code = EXIT_DONE;
	memset(&study, 0, sizeof(study));
	study.lock = study.images = -1;
	study.quotes = json_object();
	study.job.cli = cli;
	study.job.stream = stdout;
	if (study_options(&study, cli, self, argc, argv, &code)) {
		job_begin(&study.job);
		code = do_study(&study);
		job_end(&study.job);
	}
	json_decref(study.lines);
	json_decref(study.quotes);
	free(study.plan.points);
	free(study.runs);
	free(study.folder);
	if (study.images >= 0)
		close(study.images);
	if (study.lock >= 0)
		close(study.lock);
	return code;
}

const struct command study_command = {
    .name = "study",
    .summary = "show what accuracy costs in time, by every technique",
    .help =
	"Usage: candil study SCENE -o FOLDER [--camera NAME|…]… [--size WxH] [--techniques LIST] [--budget SECONDS]\n"
	"                    [--quick | --plan FILE] [--seeds N] [options] [--connect ADDR] [--json]\n\n"
	"Renders SCENE by each technique at many settings, and a reference by {noise} whose own error is known, and\n"
	"leaves in FOLDER a report to open in a browser: error against seconds, where each technique's error ends, what\n"
	"its effects cost. First runs measure the scene; then the plan is printed with the time that it takes, and\n"
	"followed. Start the same command again and it goes on where it was cut short; what is done is not done again.\n\n"
	"  -o, --output FOLDER   a new folder, or that of a study of this scene to go on with\n"
	"  --camera NAME|ex,…    a view, as candil render takes it; up to 32 times; default: its first, else its bounds\n"
	"                        are framed\n"
	"  --size WxH            pixels; default 256x256, with --quick 128x128\n"
	"  --techniques LIST     {techniques}, with commas between; default: all\n"
	"  --budget SECONDS      that the runs are planned into; default 600, with --quick 45. How exact the reference is\n"
	"                        and how many samples points have follows from it\n"
	"  --quick               few settings and seeds, no effect left out to see what it costs\n"
	"  --plan FILE           which views, settings, seeds and reference: JSON, which tests/bench/studies/README.md\n"
	"                        describes. The plan that a study follows is in its folder, too: plan.json\n"
	"  --seeds N             runs of each point with noise; default 8, with --quick 4\n"
	"  --orthographic H, --panorama, --lens RADIUS,FOCUS, --filter NAME, --background …, --background-turn DEG,\n"
	"  --background-scale S, --no-default-light, --effects LIST, --light …, --replace-lights, --material …,\n"
	"  --node …, --animation NAME, --at S, --up y|z, --unit METRES\n"
	"                        as of candil render, for all runs\n"
	"  --quiet               no plan, no progress, no summary\n\n"
	"A point with noise has a seed a run, one without a few runs for its time. The first run of a pipeline is cold\n"
	"and stands apart. Points with noise come in turns, each turn in an order of its own, so that a machine that is\n"
	"busy for a while is so for all of them; the runs of one without come one after the other, for they share what\n"
	"the first has made of the scene. A run that waited for other clients of the daemon is made again.\n\n"
	"FOLDER gets plan.json, study.json (what was studied, on what, what is missing), runs.jsonl (a line a run: what\n"
	"was asked, the command that makes it again, the report of candil render --json), images/, and from these\n"
	"report.html, results.json and results.csv. Runs that an earlier plan has left there (another size, other\n"
	"settings) are kept in others.jsonl until they are asked for again. Runs of one version of the daemon, one device\n"
	"and one scene count as the same: after a change to the renderer that has no version of its own, name a new\n"
	"folder.\n\n"
	"Ctrl-C ends it at once: what is done is kept, and the next session writes the report.\n"
	"A run that fails is told in study.json and tried again the next time; the others are made. A technique that\n"
	"cannot do what is asked is left out and named.\n\n"
	"--json: {\"folder\", \"report\" (null: there is none), \"complete\", \"missing\": [{\"run\", \"why\"}],\n"
	"\"skipped\": [{\"technique\", \"why\"}], \"runs\" (of the plan), \"made\" (now), \"why\" (there is no report; or "
	"null),\n"
	"\"seconds\", \"warnings\": [] (about the scene), \"warnings_more\"}\n"
	"Exit codes: 0 all runs are there and the report is written, 1 some are missing, or anything else; others as in\n"
	"candil --help.\n",
    .run = run_study,
};
