// The report of a study: candil-report, run where there is none of what is there.
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "clients/cli/programs.h"
#include "clients/cli/study.h"
#include "protocol/limits.h"

#define REPORT_PROGRAM "candil-report"
#define REPORT_TABLES "../../share/candil/TABLE.md" // from where the program is; it shows rows of it
// It is ended after so many times the work that it should take, and then some: it hangs.
#define REPORT_FACTOR 10
#define REPORT_LEAST_MS 600000

// Add which state a file is in: equal texts, equal contents, as far as that is known without reading them.
static void put_state(json_t *what, const char *key, const char *path)
{
	struct stat about;
	json_object_set_new(what, key,
			    stat(path, &about) != 0 ? json_null()
						    : json_sprintf("%jd bytes, %jd.%09ld", (intmax_t)about.st_size,
								   (intmax_t)about.st_mtim.tv_sec, about.st_mtim.tv_nsec));
}

// What a report made now would be made of.
static json_t *describe(const struct study *study, const char *program)
{
	static const char *const sources[] = {"runs.jsonl", "plan.json"};
	char path[PATH_MAX];
	json_t *what = json_object();
	put_state(what, REPORT_PROGRAM, program);
	if (program_libexec(REPORT_TABLES, path, sizeof(path)))
		put_state(what, "TABLE.md", path);
	for (size_t i = 0; i < sizeof(sources) / sizeof(*sources); i++)
		if (study_path(study, sources[i], path, sizeof(path)))
			put_state(what, sources[i], path);
	return what;
}

static bool has_all(const struct study *study)
{
	static const char *const results[] = {"report.html", "results.json", "results.csv"};
	char path[PATH_MAX];
	for (size_t i = 0; i < sizeof(results) / sizeof(*results); i++)
		if (!study_path(study, results[i], path, sizeof(path)) || access(path, R_OK) != 0)
			return false;
	return true;
}

static void run_program(struct study *study, char *path)
{
	static char out[4096], err[4096];
	char *argv[] = {path, study->folder, NULL};
	struct candil_error error;
	if (!program_has_room(REPORT_PROGRAM, &error)) {
		snprintf(study->report_why, sizeof(study->report_why), "%s", error.text);
		return;
	}
	const double most = REPORT_LEAST_MS + REPORT_FACTOR * 1000 * study_predict_report(study);
	progress_say(&study->job.progress, "writing the report");
	const struct program_time time = {.still_ms = 1000 * LIMIT_HANG_SECONDS, .work_ms = (unsigned)fmin(most, INT_MAX)};
	const int status = program_run(argv, time, out, err, sizeof(out));
	study->report_made = status == 0 && has_all(study);
	if (status < 0)
		snprintf(study->report_why, sizeof(study->report_why), "%s: %s", REPORT_PROGRAM, strerror(errno));
	else if (!study->report_made)
		snprintf(study->report_why, sizeof(study->report_why), "%s ended with %d: %.180s", REPORT_PROGRAM, status,
			 err);
}

void study_make_report(struct study *study)
{
	char path[PROGRAM_PATH];
	if (!program_libexec(REPORT_PROGRAM, path, sizeof(path)) || access(path, X_OK) != 0) {
		snprintf(study->report_why, sizeof(study->report_why),
			 REPORT_PROGRAM " is not installed: there are runs, images and times, and no figures");
		return;
	}
	json_t *what = describe(study, path), *before = study_read_report_of(study);
	// Whatever was made in this session has written study.json, which then says nothing of a report.
	study->report_made = has_all(study) && before && json_equal(before, what);
	if (!study->report_made) {
		run_program(study, path);
		if (study->report_made && !study_write_report_of(study, json_incref(what)))
			snprintf(study->report_why, sizeof(study->report_why), "study.json cannot be written");
	}
	json_decref(before);
	json_decref(what);
}
