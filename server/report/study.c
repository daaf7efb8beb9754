#include "server/report/study.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char *const kinds[] = {"reference", "point", "ablation", "cold"};

// ---- values of objects, which may be anything ----

// A string of at most LIMIT_STUDY_TEXT bytes, else NULL.
static const char *text_of(const json_t *object, const char *key)
{
	const json_t *value = json_object_get(object, key);
	return json_is_string(value) && json_string_length(value) <= LIMIT_STUDY_TEXT ? json_string_value(value) : NULL;
}

// A number that is finite and not below 0, else NaN.
static double number_of(const json_t *object, const char *key)
{
	const json_t *value = json_object_get(object, key);
	const double number = json_is_number(value) ? json_number_value(value) : -1;
	return isfinite(number) && number >= 0 ? number : (double)NAN;
}

// A whole number below `limit`. false: it is something else.
static bool whole_of(const json_t *value, uint64_t limit, uint64_t *out)
{
	if (!json_is_integer(value) || json_integer_value(value) < 0 || (uint64_t)json_integer_value(value) >= limit)
		return false;
	*out = (uint64_t)json_integer_value(value);
	return true;
}

static struct study_estimate estimate_of(const json_t *object, const char *value, const char *low, const char *high,
					 double unit)
{
	return (struct study_estimate){unit * number_of(object, value), unit * number_of(object, low),
				       unit * number_of(object, high)};
}

// ---- what is missing ----

char *study_whole_text(char *text)
{
	char *to = text;
	for (const char *from = text; *from;) {
		const unsigned char lead = (unsigned char)*from;
		size_t length = lead < 0x80 ? 1 : lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : lead >= 0xc0 ? 2 : 0, i = 1;
		while (i < length && ((unsigned char)from[i] & 0xc0) == 0x80)
			i++;
		if (i == length)
			for (i = 0; i < length; i++)
				*to++ = from[i];
		from += i > 0 ? i : 1;
	}
	*to = '\0';
	return text;
}

void study_miss(struct study *study, const char *id, const char *format, ...)
{
	char why[2 * LIMIT_TEXT];
	va_list args;
	va_start(args, format);
	vsnprintf(why, sizeof why, format, args);
	va_end(args);
	// What study.json misses is often a line of runs.jsonl too; the first reason of a run is the one that counts.
	if (id && id[0] && json_object_get(study->missed, id))
		return;
	if (json_array_size(study->missing) >= LIMIT_STUDY_RUNS)
		return;
	if (id && id[0])
		json_object_set_new(study->missed, id, json_true());
	json_t *text = json_string(study_whole_text(why));
	json_array_append_new(study->missing, json_pack("{s:s?, s:o}", "run", id, "why",
							text ? text : json_string("a reason that is no UTF-8")));
}

// ---- files ----

char *study_path(const struct study *study, const char *relative, struct error *err)
{
	char *joined = NULL, *path = NULL;
	const size_t length = strlen(study->folder);
	struct stat about;
	if (relative[0] == '/' || asprintf(&joined, "%s/%s", study->folder, relative) < 0) {
		error_set(err, STATUS_BAD_ARGUMENT, "\"%.100s\" is no path in the study's folder", relative);
		return NULL;
	}
	path = realpath(joined, NULL);
	if (!path)
		error_errno(err, STATUS_IO, "cannot read %.100s", relative);
	else if (strncmp(path, study->folder, length) != 0 || path[length] != '/')
		error_set(err, STATUS_BAD_ARGUMENT, "\"%.100s\" leads out of the study's folder", relative);
	else if (stat(path, &about) != 0 || !S_ISREG(about.st_mode))
		error_set(err, STATUS_BAD_ARGUMENT, "\"%.100s\" is no file", relative);
	else
		goto out;
	free(path);
	path = NULL;
out:
	free(joined);
	return path;
}

// Read a whole file. STATUS_IO, STATUS_LIMIT, STATUS_MEMORY.
static enum status read_file(const struct study *study, const char *name, size_t limit, char **text, size_t *bytes,
			     struct error *err)
{
	char *path = study_path(study, name, err);
	if (!path)
		return STATUS_IO;
	enum status s = STATUS_OK;
	struct stat about;
	FILE *file = fopen(path, "rbe");
	free(path);
	*text = NULL;
	if (!file || fstat(fileno(file), &about) != 0) {
		s = error_errno(err, STATUS_IO, "cannot read %s", name);
	} else if ((uint64_t)about.st_size > limit) {
		s = error_set(err, STATUS_LIMIT, "%s has %lld bytes; the limit is %zu", name, (long long)about.st_size,
			      limit);
	} else {
		*text = malloc((size_t)about.st_size + 1);
		if (!*text)
			s = error_set(err, STATUS_MEMORY, "no memory to read %s", name);
		else
			*bytes = fread(*text, 1, (size_t)about.st_size, file);
	}
	if (file)
		fclose(file);
	return s;
}

static enum status check_study(struct study *study, struct error *err)
{
	const json_t *size = json_object_get(study->json, "size");
	const json_t *views = json_object_get(study->json, "views");
	uint64_t version, side[2] = {0, 0};
	if (!whole_of(json_object_get(study->json, "version"), 1000, &version) || version != 1)
		return error_set(err, STATUS_BAD_ARGUMENT, "study.json is no study of version 1");
	if (!whole_of(json_array_get(size, 0), LIMIT_SIDE + 1, &side[0]) ||
	    !whole_of(json_array_get(size, 1), LIMIT_SIDE + 1, &side[1]) || side[0] == 0 || side[1] == 0)
		return error_set(err, STATUS_BAD_ARGUMENT, "study.json has no \"size\" of two whole numbers");
	if (side[0] * side[1] > LIMIT_STUDY_PIXELS)
		return error_set(err, STATUS_LIMIT, "images of %u x %u are too large for a report; the limit is %u pixels",
				 (unsigned)side[0], (unsigned)side[1], LIMIT_STUDY_PIXELS);
	study->width = (uint32_t)side[0];
	study->height = (uint32_t)side[1];
	if (!json_is_array(views) || json_array_size(views) == 0)
		return error_set(err, STATUS_BAD_ARGUMENT, "study.json has no \"views\"");
	if (json_array_size(views) > LIMIT_STUDY_VIEWS)
		return error_set(err, STATUS_LIMIT, "the study has %zu views; the limit is %u", json_array_size(views),
				 LIMIT_STUDY_VIEWS);
	study->views = (uint32_t)json_array_size(views);
	study->title = text_of(study->json, "title");
	if (!study->title || !study->title[0])
		study->title = text_of(json_object_get(study->json, "scene"), "file");
	if (!study->title || !study->title[0])
		study->title = "a study";
	const json_t *missing = json_object_get(study->json, "missing"), *entry;
	size_t i;
	json_array_foreach(missing, i, entry)
	{
		const char *why = text_of(entry, "why");
		study_miss(study, text_of(entry, "run"), "%s", why ? why : "study.json does not say why");
	}
	return STATUS_OK;
}

const char *study_view_name(const struct study *study, uint32_t view, char out[32])
{
	const char *name = text_of(json_array_get(json_object_get(study->json, "views"), view), "name");
	snprintf(out, 32, "view %u", view + 1);
	return name && name[0] ? name : out;
}

// ---- runs ----

bool study_same_but_samples(const struct study_run *a, const struct study_run *b)
{
	if (strcmp(a->technique, b->technique) != 0 || strcmp(a->effects, b->effects) != 0)
		return false;
	json_t *x = json_copy((json_t *)a->settings), *y = json_copy((json_t *)b->settings);
	json_object_del(x, "samples");
	json_object_del(y, "samples");
	const bool same = json_equal(x, y);
	json_decref(x);
	json_decref(y);
	return same;
}

static bool settings_hold(const json_t *settings)
{
	const char *key;
	json_t *value;
	if (!json_is_object(settings) || json_object_size(settings) > LIMIT_STUDY_SETTINGS)
		return false;
	json_object_foreach((json_t *)settings, key, value)
	{
		const bool text = json_is_string(value) && json_string_length(value) <= LIMIT_STUDY_TEXT;
		if (strlen(key) > LIMIT_NAME || (!text && !json_is_number(value) && !json_is_boolean(value)))
			return false;
	}
	return true;
}

// A number that does not say how it is known counts as unknown.
static void read_error(const json_t *report, struct study_run *run)
{
	const char *kind = text_of(report, "error_kind");
	run->error = estimate_of(report, "estimated_relmse", "relmse_low", "relmse_high", 1);
	if (isfinite(run->error.value) && kind && strcmp(kind, "measured") == 0) {
		run->error_kind = "measured";
	} else if (isfinite(run->error.value) && kind && strcmp(kind, "predicted") == 0) {
		run->error_kind = "predicted";
	} else {
		run->error_kind = "unknown";
		run->error = (struct study_estimate){(double)NAN, (double)NAN, (double)NAN};
	}
}

static void read_report(json_t *line, struct study_run *run)
{
	const json_t *report = json_object_get(line, "report");
	run->seconds = 1e-6 * number_of(report, "elapsed_us");
	run->cold_seconds = 1e-6 * number_of(report, "cold_us");
	if (!(run->seconds > 0))
		run->seconds = (double)NAN;
	run->warm = isfinite(run->cold_seconds) ? run->cold_seconds == 0 : json_is_true(json_object_get(line, "warm"));
	run->samples = number_of(report, "samples");
	if (!isfinite(run->samples))
		run->samples = number_of(run->settings, "samples");
	read_error(report, run);
	json_t *stages = json_object_get(report, "stages");
	if (json_is_array(stages) && json_array_size(stages) <= LIMIT_STAGES) {
		json_object_set(line, "kept stages", stages);
		run->stages = stages;
	}
	const json_t *quote = json_object_get(line, "quote");
	run->quoted_seconds = estimate_of(quote, "time_ms", "time_ms_low", "time_ms_high", 1e-3);
	run->quoted_relmse = estimate_of(quote, "relmse", "relmse_low", "relmse_high", 1);
	const char *from = text_of(quote, "from");
	run->quoted_from = from && strcmp(from, "pilot") == 0 ? "pilot" : from ? "model" : "";
}

// Fill `run` from its line, whose owner it becomes. NULL, or why it does not hold.
static const char *read_run(const struct study *study, json_t *line, struct study_run *run)
{
	const char *kind = text_of(line, "kind");
	uint64_t view;
	size_t k = 0;
	run->id = text_of(line, "id");
	run->technique = text_of(line, "technique");
	run->settings = json_object_get(line, "settings");
	while (k < 4 && !(kind && strcmp(kind, kinds[k]) == 0))
		k++;
	if (!run->id || !run->id[0])
		return "it has no id";
	if (k == 4)
		return "its kind is unknown";
	if (!whole_of(json_object_get(line, "view"), study->views, &view))
		return "its view is none of the study's";
	if (!run->technique || !run->technique[0] || strlen(run->technique) > LIMIT_NAME)
		return "it has no technique";
	if (!settings_hold(run->settings))
		return "its settings are no numbers and words";
	if (!whole_of(json_object_get(line, "seed"), INT64_MAX, &run->seed))
		return "it has no seed";
	run->kind = (enum study_kind)k;
	run->view = (uint32_t)view;
	run->image = text_of(line, "image");
	run->command = text_of(line, "command");
	run->effects = text_of(line, "effects");
	if (!run->command)
		run->command = "";
	if (!run->effects)
		run->effects = "auto";
	read_report(line, run);
	json_object_del(line, "report");
	json_object_del(line, "quote");
	char *settings = json_dumps(run->settings, JSON_COMPACT | JSON_SORT_KEYS);
	// Zero-padded, so that the order of the views is that of their numbers.
	if (!settings ||
	    asprintf(&run->group, "%zu\n%08u\n%s\n%s\n%s", k, run->view, run->technique, run->effects, settings) < 0)
		run->group = NULL;
	free(settings);
	return run->group ? NULL : "no memory is left for it";
}

static void run_finish(struct study_run *run)
{
	json_decref(run->line);
	free(run->group);
	*run = (struct study_run){0};
}

// A line of runs.jsonl. `last`: the file ends in it, without a line's end, which is how a killed study leaves it.
static void read_line(struct study *study, const char *text, size_t bytes, uint32_t number, bool last)
{
	json_error_t why;
	if (bytes == 0)
		return;
	json_t *line = bytes > LIMIT_STUDY_LINE_BYTES ? NULL : json_loadb(text, bytes, JSON_REJECT_DUPLICATES, &why);
	if (!json_is_object(line)) {
		json_decref(line);
		if (!last)
			study_miss(study, NULL, "line %u of runs.jsonl cannot be read", number);
		return;
	}
	struct study_run *run = &study->runs[study->run_count];
	*run = (struct study_run){.line = line, .number = number};
	const json_t *failed = json_object_get(line, "failed");
	const char *wrong = read_run(study, line, run);
	if (wrong) {
		study_miss(study, run->id, "line %u of runs.jsonl does not hold: %s", number, wrong);
		run_finish(run);
		return;
	}
	if (json_is_object(failed)) {
		const char *message = text_of(failed, "message");
		free(run->group);
		run->group = NULL; // marks it as failed, for drop_superseded
		json_object_set_new(line, "why", json_string(message ? message : "it failed and does not say why"));
	}
	study->run_count++;
}

static int by_id(const void *a, const void *b)
{
	const struct study_run *x = a, *y = b;
	const int order = strcmp(x->id, y->id);
	return order ? order : (x->number > y->number) - (x->number < y->number);
}

static int by_group(const void *a, const void *b)
{
	const struct study_run *x = a, *y = b;
	const int order = strcmp(x->group, y->group);
	if (order)
		return order;
	if (x->seed != y->seed)
		return x->seed > y->seed ? 1 : -1;
	return (x->number > y->number) - (x->number < y->number);
}

// A run that was tried again stands on a later line. Of each id keep the last; drop what failed to the end, and say so.
static void drop_superseded(struct study *study)
{
	size_t kept = 0;
	if (study->run_count > 0)
		qsort(study->runs, study->run_count, sizeof *study->runs, by_id);
	for (size_t i = 0; i < study->run_count; i++) {
		struct study_run *run = &study->runs[i];
		const bool superseded = i + 1 < study->run_count && strcmp(run->id, study->runs[i + 1].id) == 0;
		if (!superseded && !run->group)
			study_miss(study, run->id, "%.300s", json_string_value(json_object_get(run->line, "why")));
		if (superseded || !run->group)
			run_finish(run);
		else
			study->runs[kept++] = *run;
	}
	study->run_count = kept;
	if (kept > 0)
		qsort(study->runs, kept, sizeof *study->runs, by_group);
}

static enum status read_runs(struct study *study, struct error *err)
{
	char *text = NULL;
	size_t bytes = 0, lines = 1;
	const enum status s = read_file(study, "runs.jsonl", LIMIT_STUDY_BYTES, &text, &bytes, err);
	if (s == STATUS_IO) {
		study_miss(study, NULL, "no run has finished: %s", err->text);
		return STATUS_OK;
	}
	if (s != STATUS_OK)
		return s;
	for (size_t i = 0; i < bytes; i++)
		lines += text[i] == '\n';
	if (lines > LIMIT_STUDY_RUNS + 1) {
		free(text);
		return error_set(err, STATUS_LIMIT, "runs.jsonl has %zu lines; the limit is %u", lines, LIMIT_STUDY_RUNS);
	}
	study->runs = calloc(lines, sizeof *study->runs);
	if (!study->runs) {
		free(text);
		return error_set(err, STATUS_MEMORY, "no memory for %zu runs", lines);
	}
	uint32_t number = 1;
	for (size_t at = 0; at < bytes; number++) {
		const char *end = memchr(text + at, '\n', bytes - at);
		const size_t length = end ? (size_t)(end - (text + at)) : bytes - at;
		read_line(study, text + at, length, number, !end);
		at += length + 1;
	}
	free(text);
	drop_superseded(study);
	return STATUS_OK;
}

enum status study_read(const char *folder, struct study *study, struct error *err)
{
	char *text = NULL;
	size_t bytes = 0;
	json_error_t why;
	*study = (struct study){.missing = json_array(), .missed = json_object()};
	study->folder = realpath(folder, NULL);
	if (!study->folder)
		return error_errno(err, STATUS_IO, "cannot read %s", folder);
	enum status s = read_file(study, "study.json", LIMIT_STUDY_LINE_BYTES, &text, &bytes, err);
	if (s != STATUS_OK)
		return s;
	study->json = json_loadb(text, bytes, JSON_REJECT_DUPLICATES, &why);
	free(text);
	if (!json_is_object(study->json))
		return error_set(err, STATUS_BAD_ARGUMENT, "study.json is no JSON object: %s",
				 study->json ? "something else" : why.text);
	s = check_study(study, err);
	return s == STATUS_OK ? read_runs(study, err) : s;
}

void study_finish(struct study *study)
{
	for (size_t i = 0; i < study->run_count; i++)
		run_finish(&study->runs[i]);
	free(study->runs);
	free(study->folder);
	json_decref(study->json);
	json_decref(study->missing);
	json_decref(study->missed);
	*study = (struct study){0};
}
