// study: what accuracy costs in time on one scene, by every technique.
#include "clients/cli/study.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "clients/cli/interrupt.h"
#include "clients/cli/programs.h"

#define REPORT_PROGRAM "candil-report"
#define REPORT_MS 600000
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
				     study->job.target.picture_hash,
				     CANDIL_VERSION_STRING,
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

// ---- the report ------------------------------------------------------------------------------------------------------

static bool modified(const struct study *study, const char *name, struct timespec *out)
{
	char path[PATH_MAX];
	struct stat about;
	if (!study_path(study, name, path, sizeof(path)) || stat(path, &about) != 0)
		return false;
	*out = about.st_mtim;
	return true;
}

// Whether the report that is there was made of all that is there.
static bool is_report_there(const struct study *study)
{
	static const char *const sources[] = {"runs.jsonl", "study.json", "plan.json"};
	struct timespec report, source;
	if (!modified(study, "report.html", &report))
		return false;
	for (size_t i = 0; i < sizeof(sources) / sizeof(*sources); i++)
		if (!modified(study, sources[i], &source) || source.tv_sec > report.tv_sec ||
		    (source.tv_sec == report.tv_sec && source.tv_nsec > report.tv_nsec))
			return false;
	return true;
}

static void make_report(struct study *study)
{
	static char out[4096], err[4096];
	char path[PROGRAM_PATH];
	struct timespec made;
	if (is_report_there(study)) {
		study->report_made = true;
		return;
	}
	if (!program_libexec(REPORT_PROGRAM, path, sizeof(path)) || access(path, X_OK) != 0) {
		study_note(study, REPORT_PROGRAM " is not installed: there are runs, images and times, and no figures");
		return;
	}
	progress_say(&study->job.progress, "writing the report");
	char *argv[] = {path, study->folder, NULL};
	const int status = program_run(argv, REPORT_MS, out, err, sizeof(out));
	study->report_made = status == 0 && modified(study, "report.html", &made);
	if (status < 0)
		snprintf(study->report_why, sizeof(study->report_why), "%s: %s", REPORT_PROGRAM, strerror(errno));
	else if (!study->report_made)
		snprintf(study->report_why, sizeof(study->report_why), "%s ended with %d: %.180s", REPORT_PROGRAM, status,
			 err);
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
	snprintf(study->vulkan, sizeof(study->vulkan), "%s", stats.device);
	return EXIT_DONE;
}

static enum exit_code open_all(struct study *study)
{
	enum exit_code code = study_open_folder(study);
	if (code == EXIT_DONE)
		code = job_open(&study->job);
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
	if (!idle)
		code = study_write_state(study);
	if (code == EXIT_DONE)
		code = make_runs(study);
	if (study->made > 0 || !idle) {
		// What was made so far can be looked at, whatever ended it.
		write_utc(study->ended_at);
		const enum exit_code written = study_write_state(study);
		code = code == EXIT_DONE ? written : code;
	}
	if (code != EXIT_CANCELLED)
		make_report(study);
	return code == EXIT_DONE ? study_say_end(study) : code;
}

static enum exit_code run_study(struct cli *cli, const struct command *self, int argc, char **argv)
{
	// Static because it is too large for the stack; a process runs one command.
	static struct study study;
	enum exit_code code = EXIT_DONE;
	memset(&study, 0, sizeof(study));
	study.lock = -1;
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
	"  -o, --output FOLDER   a new folder, or that of a study to go on with\n"
	"  --camera NAME|ex,…    a view, as candil render takes it; up to 32 times; default: its first, else its bounds\n"
	"                        are framed\n"
	"  --size WxH            pixels; default 256x256, with --quick 128x128\n"
	"  --techniques LIST     {techniques}, with commas between; default: all\n"
	"  --budget SECONDS      that the runs are planned into; default 600, with --quick 35. How exact the reference is\n"
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
	"and stands apart. Points come in turns, each turn in an order of its own, so that a machine that is busy for a\n"
	"while is so for all of them.\n\n"
	"FOLDER gets plan.json, study.json (what was studied, on what, what is missing), runs.jsonl (a line a run: what\n"
	"was asked, the command that makes it again, the report of candil render --json), images/, and from these\n"
	"report.html, results.json and results.csv.\n\n"
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
