// A study's folder as it is read: study.json, and runs.jsonl with one finished or failed run a line. Whatever is in them
// came from outside: types, lengths and counts are checked, a line that does not hold is left out and named as missing, and
// no path leads out of the folder. One thread; the strings are UTF-8 and belong to the study.
#ifndef CANDIL_REPORT_STUDY_H
#define CANDIL_REPORT_STUDY_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "server/base/error.h"

enum study_kind { STUDY_REFERENCE, STUDY_POINT, STUDY_ABLATION, STUDY_COLD };

// What was said of a number before it was known, or of an error by whoever made it. NaN: unknown.
struct study_estimate {
	double value, low, high;
};

struct study_run {
	json_t *line; // owns what the strings below are in; without the report and the quote but their parts that are kept
	uint32_t number; // of its line, from 1
	enum study_kind kind;
	uint32_t view;
	const char *id, *technique, *effects, *command;
	const char *image; // relative to the folder; NULL: none
	char *group; // equal for the runs of one point: kind, view, technique, effects, settings; freed by study_finish
	const json_t *settings; // an object of numbers, strings and truths
	double samples; // of a pixel; NaN: unknown
	uint64_t seed;
	bool warm; // nothing had to be compiled for it
	double seconds, cold_seconds; // from arrival to the last byte, and of these compiling; NaN: unknown
	const json_t *stages; // [{"name", "us"}], may be NULL
	const char *error_kind; // "measured", "predicted" or "unknown"
	struct study_estimate error; // relMSE as the reply had it
	struct study_estimate quoted_seconds, quoted_relmse; // by the quote that was asked before it ran
	const char *quoted_from; // "model" or "pilot"; "" without a quote
};

struct study {
	json_t *json; // study.json
	char *folder; // resolved
	const char *title;
	uint32_t views;
	uint32_t width, height;
	struct study_run *runs; // sorted by group, then by seed, then by line
	size_t run_count;
	json_t *missing; // [{"run", "why"}]: what study.json misses, failed runs, lines and images that do not hold
	json_t *missed; // the runs of these, as keys
};

// Read a study. STATUS_IO: no study.json, or the folder cannot be read; STATUS_BAD_ARGUMENT: study.json is no such thing;
// STATUS_LIMIT: more than LIMIT_STUDY_… allow; STATUS_MEMORY. A missing or torn runs.jsonl is no failure.
enum status study_read(const char *folder, struct study *study, struct error *err);
void study_finish(struct study *study); // a zeroed one is fine

// Note that something is missing: of run `id`, or NULL for the study's own. At most LIMIT_STUDY_RUNS are kept, and one of a
// run: the first. What is no UTF-8 in the text, such as a character that was cut, is left out.
void study_miss(struct study *study, const char *id, const char *format, ...) __attribute__((format(printf, 3, 4)));

// Leave out the bytes of a text that belong to no whole UTF-8 character, as where it was cut. Returns it.
char *study_whole_text(char *text);

// The path of a file of the folder that `relative` names, to be freed. NULL, and the reason in `err`: it is absolute, leads
// out of the folder, also by a link, or is no regular file.
char *study_path(const struct study *study, const char *relative, struct error *err);

// Whether two runs have the same technique, effects and settings but for the samples.
bool study_same_but_samples(const struct study_run *a, const struct study_run *b);

// A view's name: study.json's, else "view 1", "view 2"… in `out`.
const char *study_view_name(const struct study *study, uint32_t view, char out[32]);

#endif
