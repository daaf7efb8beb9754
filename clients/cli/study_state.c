// The folder of a study. What is in it was written by an earlier session, which may have been killed at any point, or by
// anybody else: of a line of runs.jsonl only the id counts until a whole image of that name is found, and no path is read
// from it.
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <unistd.h>

#include "clients/cli/output.h"
#include "clients/cli/study.h"
#include "clients/cli/verify.h"
#include "clients/libcandil/error.h"
#include "server/base/temporary.h"

#define RUNS_FILE "runs.jsonl"
#define OTHERS_FILE "others.jsonl"
#define PLAN_FILE "plan.json"
#define STATE_FILE "study.json"
#define MISSING_MAX 400u // runs that study.json names, whose sentences are long: the reader takes 1 MiB of it at most
#define RUNS_BYTES (256L << 20) // of runs.jsonl at most
#define LINE_BYTES (1u << 20) // of one line that counts

static enum exit_code refuse_folder(struct study *study, const char *why)
{
	struct candil_error error;
	error_set(&error, CANDIL_STATUS_BAD_ARGUMENT, "%.120s %s", study->job.options.output, why);
	return job_fail(&study->job, &error);
}

// ---- files -----------------------------------------------------------------------------------------------------------

bool study_save(const struct study *study, int folder, const char *name, const void *data, size_t bytes)
{
	// In the study's own folder, not that of the file: images/ has images alone, whenever it is looked at.
	struct temporary temporary;
	const bool good = temporary_open(&temporary, study->lock, ".", 0666) && place_write_all(temporary.fd, data, bytes) &&
			  temporary_place(&temporary, folder, name);
	temporary_finish(&temporary);
	return good;
}

// ---- runs.jsonl ------------------------------------------------------------------------------------------------------

// Keep a line if it is an object with an id; of two of one id the later. A torn one is none.
static void keep_line(struct study *study, const char *text, size_t bytes)
{
	json_t *line = bytes <= LINE_BYTES ? json_loadb(text, bytes, JSON_REJECT_DUPLICATES, NULL) : NULL;
	const char *id = json_string_value(json_object_get(line, "id"));
	if (id && strlen(id) < STUDY_ID)
		json_object_set(study->lines, id, line);
	json_decref(line);
}

static bool read_lines(struct study *study, FILE *file)
{
	struct stat about;
	char *text = NULL;
	size_t capacity = 0;
	ssize_t bytes;
	if (fstat(fileno(file), &about) != 0 || !S_ISREG(about.st_mode) || about.st_size > RUNS_BYTES) {
		errno = EFBIG;
		return false;
	}
	while ((bytes = getline(&text, &capacity, file)) > 0)
		keep_line(study, text, (size_t)bytes);
	free(text);
	return !ferror(file);
}

static enum exit_code read_runs(struct study *study, const char *name)
{
	char what[64];
	const int fd = openat(study->lock, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
	FILE *file = fd >= 0 ? fdopen(fd, "rb") : NULL;
	if (!file && errno == ENOENT)
		return EXIT_DONE;
	const bool good = file && read_lines(study, file);
	const int failure = errno;
	if (file)
		fclose(file);
	errno = failure;
	snprintf(what, sizeof(what), "%s cannot be read", name);
	return good ? EXIT_DONE : cli_fail_errno(study->job.cli, what, study->job.stream);
}

void study_find_run(struct study *study, struct study_run *run)
{
	static struct metadata metadata; // static because it is large
	char name[STUDY_ID + 16], path[PATH_MAX];
	const json_t *line = json_object_get(study->lines, run->id);
	const json_t *report = json_object_get(line, "report");
	const json_t *us = json_object_get(report, "elapsed_us");
	metadata.count = 0;
	snprintf(name, sizeof(name), "images/%s.exr", run->id);
	run->done = json_is_integer(us) && study_path(study, name, path, sizeof(path)) &&
		    verify_image(path, false, study->plan.width, study->plan.height, &metadata);
	if (run->done && run->kind == STUDY_COLD)
		study_learn_cold(study, study->plan.points[run->point].technique, json_number_value(us),
				 json_number_value(json_object_get(report, "cold_us")));
	if (!run->done || run->kind == STUDY_REFERENCE || run->kind == STUDY_COLD)
		return;
	struct study_times *times = &study->plan.points[run->point].times[run->view];
	times->seconds += (double)json_integer_value(us) * 1e-6;
	times->runs++;
}

// A line that a kill has torn must not take the next one with it.
static bool end_torn_line(int fd)
{
	char last = '\n';
	const off_t end = lseek(fd, 0, SEEK_END);
	if (end < 0 || (end > 0 && pread(fd, &last, 1, end - 1) != 1))
		return false;
	return last == '\n' || place_write_all(fd, "\n", 1);
}

enum exit_code study_append(struct study *study, const char *id, json_t *line)
{
	char *text = line ? json_dumps(line, JSON_COMPACT | JSON_REAL_PRECISION(12)) : NULL;
	const size_t bytes = text ? strlen(text) : 0;
	int fd = -1;
	bool good = false;
	errno = ENOMEM;
	if (text) {
		text[bytes] = '\n'; // in the place of the zero
		fd = openat(study->lock, RUNS_FILE, O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
		good = fd >= 0 && end_torn_line(fd) && place_write_all(fd, text, bytes + 1) && fdatasync(fd) == 0;
	}
	const int failure = errno;
	if (fd >= 0)
		close(fd);
	free(text);
	if (good)
		json_object_set(study->lines, id, line);
	json_decref(line);
	errno = failure;
	return good ? EXIT_DONE : job_fail_output(&study->job, RUNS_FILE);
}

static bool is_good(const json_t *line)
{
	return json_is_integer(json_object_get(json_object_get(line, "report"), "elapsed_us"));
}

// Write lines to a file of the folder, unless they are what it has: nothing to take out, and no torn end.
static bool save_lines(const struct study *study, const char *name, json_t *lines)
{
	char *text = NULL;
	size_t bytes = 0;
	const char *id;
	json_t *line;
	struct stat about = {0};
	FILE *out = open_memstream(&text, &bytes);
	json_object_foreach(lines, id, line)
	{
		if (out && json_dumpf(line, out, JSON_COMPACT | JSON_REAL_PRECISION(12)) == 0)
			fputc('\n', out);
	}
	bool good = out && fclose(out) == 0;
	if (good && bytes > RUNS_BYTES) {
		errno = EFBIG; // it could not be read again
		good = false;
	}
	const bool there = fstatat(study->lock, name, &about, AT_SYMLINK_NOFOLLOW) == 0;
	if (good && (there ? about.st_size != (off_t)bytes : bytes > 0))
		good = study_save(study, study->lock, name, text, bytes);
	const int failure = errno;
	free(text);
	errno = failure;
	return good;
}

enum exit_code study_prune(struct study *study)
{
	json_t *kept = json_object(), *others = json_object(), *line;
	const char *id;
	for (uint32_t i = 0; i < study->run_count; i++) {
		id = study->runs[i].id;
		line = json_object_get(study->lines, id);
		if (study->runs[i].done && line)
			json_object_set(kept, id, line);
		json_object_del(study->lines, id);
	}
	json_object_foreach(study->lines, id, line)
	{
		if (is_good(line))
			json_object_set(others, id, line);
	}
	json_decref(study->lines);
	study->lines = kept;
	const bool good = save_lines(study, OTHERS_FILE, others);
	json_decref(others);
	return good && save_lines(study, RUNS_FILE, kept) ? EXIT_DONE : job_fail_output(&study->job, RUNS_FILE);
}

// ---- the folder ------------------------------------------------------------------------------------------------------

// Whether nobody's but a study's files can be in it: it is empty, or has the plan or the runs of one.
static bool is_ours(const struct study *study)
{
	char path[PATH_MAX];
	static const char *const names[] = {PLAN_FILE, RUNS_FILE, STATE_FILE};
	for (size_t i = 0; i < sizeof(names) / sizeof(*names); i++)
		if (study_path(study, names[i], path, sizeof(path)) && access(path, F_OK) == 0)
			return true;
	DIR *folder = opendir(study->folder);
	bool empty = folder != NULL;
	for (const struct dirent *entry; empty && (entry = readdir(folder));)
		empty = strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0;
	if (folder)
		closedir(folder);
	return empty;
}

enum exit_code study_open_folder(struct study *study)
{
	const char *name = study->job.options.output;
	study->lines = json_object();
	if (mkdir(name, 0777) != 0 && errno != EEXIST)
		return job_fail_output(&study->job, name);
	study->folder = realpath(name, NULL);
	if (!study->folder)
		return job_fail_output(&study->job, name);
	if (!is_ours(study))
		return refuse_folder(study, "is not empty and is no study: name a new folder");
	study->lock = open(study->folder, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
	if (study->lock < 0)
		return job_fail_output(&study->job, name);
	if (flock(study->lock, LOCK_EX | LOCK_NB) != 0)
		return refuse_folder(study, "is being written by another study: wait for it, or name another folder");
	if (mkdirat(study->lock, "images", 0777) != 0 && errno != EEXIST)
		return job_fail_output(&study->job, "images");
	study->images = openat(study->lock, "images", O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
	if (study->images < 0)
		return refuse_folder(study, "has an images/ that is no folder of its own: name another folder");
	const enum exit_code code = read_runs(study, OTHERS_FILE);
	return code == EXIT_DONE ? read_runs(study, RUNS_FILE) : code;
}

// Write an object to a file of the folder, whole or not at all. The object is released. false: errno says why.
static bool write_object(struct study *study, const char *name, json_t *object)
{
	char *text = object ? json_dumps(object, JSON_INDENT(1) | JSON_REAL_PRECISION(12)) : NULL;
	errno = ENOMEM;
	const bool good = text && study_save(study, study->lock, name, text, strlen(text));
	const int failure = errno;
	free(text);
	json_decref(object);
	errno = failure;
	return good;
}

bool study_read_own_plan(struct study *study, const char *key)
{
	char path[PATH_MAX];
	struct candil_error error;
	struct stat about;
	struct study_plan plan = study->plan;
	plan.points = NULL;
	plan.point_count = 0;
	if (!study_path(study, PLAN_FILE, path, sizeof(path)) || stat(path, &about) != 0 || !S_ISREG(about.st_mode) ||
	    study_plan_read(path, ~0u, &plan, &error) != CANDIL_STATUS_OK || strcmp(plan.key, key) != 0) {
		free(plan.points);
		return false;
	}
	free(study->plan.points);
	study->plan = plan;
	return true;
}

enum exit_code study_write_plan(struct study *study)
{
	return write_object(study, PLAN_FILE, study_plan_json(&study->plan)) ? EXIT_DONE
									     : job_fail_output(&study->job, PLAN_FILE);
}

// What is in study.json; NULL: nothing. A pipe of that name is not waited for.
static json_t *read_state(const struct study *study)
{
	const int fd = openat(study->lock, STATE_FILE, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
	FILE *file = fd >= 0 ? fdopen(fd, "rb") : NULL;
	json_t *state = file ? json_loadf(file, 0, NULL) : NULL;
	if (file)
		fclose(file);
	else if (fd >= 0)
		close(fd);
	return state;
}

enum exit_code study_check_scene(struct study *study)
{
	struct candil_error error;
	json_t *state = read_state(study);
	const json_t *scene = json_object_get(state, "scene");
	const char *hash = json_string_value(json_object_get(scene, "hash")),
		   *file = json_string_value(json_object_get(scene, "file"));
	const bool other = hash && strcmp(hash, study->job.target.info.hash) != 0 && json_object_size(study->lines) > 0;
	error_set(
	    &error, CANDIL_STATUS_BAD_ARGUMENT,
	    "%.100s is the study of another scene, or of this one as it was before (%.80s): name a new folder, or remove "
	    "that one",
	    study->job.options.output, file ? file : "?");
	json_decref(state);
	return other ? job_fail(&study->job, &error) : EXIT_DONE;
}

json_t *study_read_report_of(const struct study *study)
{
	json_t *file = read_state(study), *what = json_incref(json_object_get(file, "report_of"));
	json_decref(file);
	return what;
}

bool study_write_report_of(const struct study *study, json_t *what)
{
	json_t *file = read_state(study);
	json_object_set_new(file, "report_of", what);
	char *text = file ? json_dumps(file, JSON_INDENT(1) | JSON_REAL_PRECISION(12)) : NULL;
	const bool good = text && study_save(study, study->lock, STATE_FILE, text, strlen(text));
	free(text);
	json_decref(file);
	return good;
}

bool study_is_ended(const struct study *study)
{
	json_t *file = read_state(study);
	const bool ended = json_is_true(json_object_get(file, "complete"));
	json_decref(file);
	return ended;
}

// ---- study.json ------------------------------------------------------------------------------------------------------

static json_t *machine_json(void)
{
	char cpu[128] = "", line[256];
	double load = 0;
	struct utsname os = {0};
	FILE *file = fopen("/proc/cpuinfo", "re");
	while (file && !cpu[0] && fgets(line, sizeof(line), file)) {
		const char *colon = strncmp(line, "model name", 10) == 0 ? strchr(line, ':') : NULL;
		if (colon)
			snprintf(cpu, sizeof(cpu), "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
	}
	if (file)
		fclose(file);
	uname(&os);
	const bool has_load = getloadavg(&load, 1) == 1;
	return json_pack("{s:o,s:o,s:o,s:o}", "cpu", cpu[0] ? cli_json_text(cpu) : json_null(), "cores",
			 json_integer(sysconf(_SC_NPROCESSORS_ONLN)), "os",
			 json_sprintf("%s %s %s", os.sysname, os.release, os.machine), "load",
			 has_load ? json_real(load) : json_null());
}

static json_t *varied_json(const struct study *study)
{
	json_t *o = json_object();
	for (uint32_t i = 0; i < study->plan.point_count; i++) {
		const struct study_point *p = &study->plan.points[i];
		const char *technique = technique_name(p->technique);
		json_t *names = json_object_get(o, technique);
		if (!names) {
			names = json_pack("[s]", "samples");
			json_object_set_new(o, technique, names);
		}
		for (uint32_t j = 0; j < p->setting_count; j++) {
			bool known = false;
			for (size_t k = 0; k < json_array_size(names); k++)
				known |= strcmp(json_string_value(json_array_get(names, k)), p->settings[j].name) == 0;
			if (!known)
				json_array_append_new(names, json_string(p->settings[j].name));
		}
	}
	return o;
}

json_t *study_missing_json(const struct study *study)
{
	char unmade[192];
	json_t *missing = json_array();
	snprintf(unmade, sizeof(unmade), "not made yet%s%s", study->ended_why[0] ? ": " : "", study->ended_why);
	for (uint32_t i = 0; i < study->run_count; i++) {
		const struct study_run *r = &study->runs[i];
		if (!r->done)
			json_array_append_new(missing, json_pack("{s:s,s:o}", "run", r->id, "why",
								 cli_json_text(r->why[0] ? r->why : unmade)));
	}
	return missing;
}

json_t *study_skipped_json(const struct study *study)
{
	json_t *skipped = json_array();
	for (unsigned t = 1; t < TECHNIQUE_COUNT; t++) {
		bool done = false;
		const char *why = NULL;
		for (uint32_t i = 0; i < study->run_count; i++) {
			const struct study_run *r = &study->runs[i];
			if (r->kind == STUDY_REFERENCE || study->plan.points[r->point].technique != t)
				continue;
			done |= r->done;
			why = r->why[0] ? r->why : why;
		}
		if (!done && why)
			json_array_append_new(
			    skipped, json_pack("{s:s,s:o}", "technique", technique_name(t), "why", cli_json_text(why)));
	}
	return skipped;
}

// Name so many of the runs that are missing, and say how many more there are.
static void cap_missing(json_t *missing)
{
	const size_t count = json_array_size(missing);
	if (count <= MISSING_MAX)
		return;
	for (size_t i = count; i > MISSING_MAX; i--)
		json_array_remove(missing, i - 1);
	json_array_append_new(
	    missing, json_pack("{s:n,s:o}", "run", "why", json_sprintf("%zu more runs are missing", count - MISSING_MAX)));
}

bool study_write_state(struct study *study)
{
	const struct study_plan *plan = &study->plan;
	const struct candil_scene_info *info = &study->job.target.info;
	json_t *views = json_array(), *techniques = json_array(), *notes = json_array(),
	       *missing = study_missing_json(study);
	const char *scene_name = strrchr(study->job.options.scene, '/');
	scene_name = scene_name && scene_name[1] ? scene_name + 1 : study->job.options.scene;
	for (uint32_t i = 0; i < plan->view_count; i++) {
		const struct study_view *v = &plan->views[i];
		json_array_append_new(views, json_pack("{s:o,s:o}", "name", cli_json_text(v->name), "camera",
						       v->camera[0] ? cli_json_text(v->camera) : json_null()));
	}
	for (unsigned t = 1; t < TECHNIQUE_COUNT; t++)
		if (study->techniques & 1u << t)
			json_array_append_new(techniques, json_string(technique_name(t)));
	for (uint32_t i = 0; i < study->note_count; i++)
		json_array_append_new(notes, cli_json_text(study->notes[i]));
	json_t *scene =
	    json_pack("{s:o,s:o,s:o,s:o,s:o,s:o,s:o}", "file", cli_json_text(study->job.options.scene), "hash",
		      cli_json_text(info->hash), "triangles", cli_json_u64(info->triangles), "materials",
		      cli_json_u64(info->materials), "textures", cli_json_u64(info->textures), "emissive_triangles",
		      cli_json_u64(info->emissive_triangles), "punctual_lights", cli_json_u64(info->punctual_lights));
	const bool complete = json_array_size(missing) == 0 && study->ended_at[0];
	cap_missing(missing);
	json_t *o = json_pack(
	    "{s:i,s:o,s:o,s:s,s:o,s:o,s:s,s:o,s:[o,o],s:o,s:o,s:o,s:o,s:f,s:o,s:b,s:b,s:o,s:o,s:o,s:o}", "version", 1,
	    "scene", scene, "command", cli_json_text(study->command), "candil", CANDIL_VERSION_STRING, "device",
	    cli_json_text(study->device), "machine", machine_json(), "started", study->started_at, "ended",
	    study->ended_at[0] ? json_string(study->ended_at) : json_null(), "size", cli_json_u64(plan->width),
	    cli_json_u64(plan->height), "views", views, "techniques", techniques, "title",
	    cli_json_text(plan->title[0] ? plan->title : scene_name), "settings_varied", varied_json(study), "budget_s",
	    plan->budget_s, "seeds", cli_json_u64(plan->seeds), "quick", study->texts.quick, "complete", complete, "missing",
	    missing, "skipped", study_skipped_json(study), "notes", notes, "order_seed", cli_json_u64(STUDY_REFERENCE_SEED));
	return write_object(study, STATE_FILE, o);
}
