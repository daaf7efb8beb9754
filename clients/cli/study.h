// What the files of `candil study` share: its plan, its runs, and what is on disk of both. A study asks one scene of every
// technique at many settings, and of a path-traced reference, and leaves a folder that candil-report makes figures of.
//
//	study_base.c     what all of these lean on
//	study_points.c   the points of a plan
//	study_plan.c     a plan file, read, checked and written
//	study_options.c  the command line
//	study_state.c    the folder: runs.jsonl, plan.json, study.json
//	study_request.c  what a run asks for
//	study_list.c     the runs of a plan: their ids and their order
//	study_time.c     how long runs will take
//	study_say.c      what is said of it all
//	study_runner.c   one run: its image and its line
//	study_fit.c      first runs that measure the scene, and the samples and the reference that fit into the budget
//	study_report.c   candil-report, run when what is there has no report yet
//	study.c          the command: all of these in their order
//
// The folder:
//
//	plan.json        the plan that is followed, as a plan file; "key" names what it was made for
//	runs.jsonl       a line a run of the plan that ended, appended once its image is in place. A run's id is made of what
// is 	                 asked 	others.jsonl     good lines that are of no run of the plan that is followed now, but of one
// before it: another
// size, 	                 other settings. They count again when they are asked for again; nothing takes them or their
// images away 	images/ID.exr
// its image 	study.json       what was studied, on what, and what is missing; written at the start and the end
#ifndef CANDIL_CLI_STUDY_H
#define CANDIL_CLI_STUDY_H

#include "clients/cli/job.h"
#include "protocol/limits.h"
#include "protocol/names.h"

#define STUDY_VIEWS_MAX 32u
#define STUDY_POINTS_MAX 1024u // of a plan, all grids spread out
#define STUDY_VALUES_MAX 64u // of one setting of a grid
#define STUDY_SEEDS_MAX 1000u
#define STUDY_RUNS_MAX 65536u
#define STUDY_BUDGET_MAX 604800.0 // seconds: a week
#define STUDY_SETTINGS_MAX LIMIT_OPTIONS
#define STUDY_PLAN_BYTES (1u << 20) // of a plan file
#define STUDY_SAMPLES_FIT 0u // of a point: as many points, of 1, 4, 16… samples, as fit into the budget
#define STUDY_ID 64u
#define STUDY_DIGITS 6 // of a number of a plan, in its file and on the command lines of its runs alike

// The reference's seed. The other runs of a study count theirs from 1, so none has this one.
#define STUDY_REFERENCE_SEED 726566657u

enum study_kind { STUDY_REFERENCE, STUDY_POINT, STUDY_ABLATION, STUDY_COLD };

struct study_setting {
	char name[LIMIT_OPTION_NAME + 1], value[LIMIT_OPTION_VALUE + 1];
};

// A view of the scene, and the reference of it.
struct study_view {
	char name[LIMIT_NAME + 1];
	char camera[256]; // as --camera takes it; "": the scene's first, or its bounds framed
	double relmse; // the error at which the reference ends; 0: what fits
	uint32_t samples; // that the reference has at most; 0: what fits
};

// What was measured of a point in one view.
struct study_times {
	double seconds; // of all its warm runs together, on this program's clock
	uint32_t runs;
};

// Settings of a technique that are looked at.
struct study_point {
	enum study_kind kind; // STUDY_POINT, or STUDY_ABLATION: with effects of its own
	unsigned technique;
	uint32_t samples;
	struct study_setting settings[STUDY_SETTINGS_MAX];
	uint32_t setting_count;
	char effects[256]; // as --effects takes them, in the place of the command line's; "": those
	uint32_t seeds; // how many runs a view; 0: as the plan has it
	bool probe; // it is there to be measured alone
	struct study_times times[STUDY_VIEWS_MAX];
	uint32_t failures; // in this session
	char why[256]; // of the last of them
};

struct study_plan {
	char title[128];
	uint32_t width, height;
	struct study_view views[STUDY_VIEWS_MAX];
	uint32_t view_count;
	uint32_t seeds; // runs of a point with noise
	uint32_t repeats; // of one without, for its time
	double budget_s;
	bool ablations; // one of each effect of the scene is to be made
	bool reference; // there is one
	uint64_t reference_seed;
	struct study_setting reference_settings[STUDY_SETTINGS_MAX];
	uint32_t reference_setting_count;
	struct study_point *points;
	uint32_t point_count;
	double planned_s; // what the plan was thought to take, all told; 0: it is not fitted
	uint32_t left_out; // settings of techniques without noise that did not fit into the budget
	char key[17]; // what it was made for; "": it is a file of somebody else's
};

struct study_run {
	char id[STUDY_ID];
	enum study_kind kind;
	uint32_t view, point; // of a reference no point
	uint64_t seed;
	bool done, failed;
	char why[256]; // it failed
};

// What only `candil study` takes on the command line.
struct study_texts {
	const char *cameras[STUDY_VIEWS_MAX];
	uint32_t camera_count;
	const char *techniques, *budget, *plan, *seeds;
	bool quick, sized, too_many;
	char effects[192]; // of all points that have none of their own; "": auto
	char shared[2048]; // render's options that count for all runs, quoted for a shell, each behind a space
	bool shared_full;
};

struct study {
	struct job job;
	struct study_texts texts;
	unsigned techniques; // bits 1u << technique: those that are studied
	struct study_plan plan;
	struct study_run *runs; // in the order in which they are made
	uint32_t run_count;
	json_t *lines; // of runs.jsonl: an object by id
	json_t *quotes; // of this session, by the id of the run that they are about
	char *folder; // without links
	int lock; // the folder, open and locked; files of it are written by this, so that no link leads out of it
	int images; // its images/, likewise
	char command[4096]; // of this session, quoted for a shell
	char device[128], vulkan[128]; // of the first run; that the daemon names
	const char *server; // the daemon's own name and version; the client's
	char ended_why[128]; // why runs of the plan were not made; "": the study goes on, or all were tried
	double started; // on the monotonic clock, seconds
	char started_at[32], ended_at[32]; // UTC; ended_at is "" while it runs
	char notes[8][256];
	uint32_t note_count;
	uint32_t last_point, last_view; // of the run before, for what the scene keeps for it
	bool has_last;
	uint32_t made; // runs of this session, those that are not written among them
	double said; // when progress was told last
	const struct study_run *now; // that is being made; NULL: none
	double fraction; // of it that is done
	uint32_t waited; // runs whose time has waits for others in it, though they were made again
	double cold_s[TECHNIQUE_COUNT]; // that programs took to compile in the last run that was cold, by technique
	double ready_s[TECHNIQUE_COUNT]; // that this run took besides, what the scene keeps for the others among it
	bool report_made;
	char report_why[256]; // it was not
};

// ---- study_base.c ---------------------------------------------------------------------------------------------------

// Seconds on the monotonic clock.
double study_clock(void);
bool study_has_noise(unsigned technique);
const char *study_kind_name(enum study_kind kind);
// Keep what a cold run took, all told and compiling.
void study_learn_cold(struct study *study, unsigned technique, double elapsed_us, double cold_us);
// Keep a sentence for study.json and the summary.
void study_note(struct study *study, const char *format, ...) __attribute__((format(printf, 2, 3)));
// A hash of a text and its zero, on top of another; FNV-1a.
uint64_t study_hash(uint64_t hash, const char *text);
// A number of so many digits: a file or a command line that has these says the same.
double study_round(double x, int digits);
// Append a space and a word, so that a shell takes it as one. *full: it did not fit.
void study_quote(char *text, size_t capacity, const char *word, bool *full);
// The path of a file of the folder. false, with errno: it is too long.
bool study_path(const struct study *study, const char *name, char *path, size_t capacity);

// ---- study_points.c -------------------------------------------------------------------------------------------------

// Add a point, unless there is an equal one. false: there is no room or no memory.
bool study_add_point(struct study_plan *plan, const struct study_point *point);
// Fill in the points of a study without a plan file, by the knobs of names.h. false: likewise.
bool study_default_points(struct study *study);
// Whether two points differ in their samples alone.
bool study_is_series(const struct study_point *a, const struct study_point *b);
// Whether a point is the first listed of its series.
bool study_is_first(const struct study_plan *plan, uint32_t point);
// Bring the points of a technique together, and those of a series in the order of their samples.
void study_sort_points(struct study_plan *plan);
// Whether a point is the technique's own defaults at these samples.
bool study_is_plain(const struct study_point *point, unsigned technique, uint32_t samples);
// The runs that a point takes in each view.
uint32_t study_seeds_of(const struct study_plan *plan, const struct study_point *point);

// ---- study_plan.c ---------------------------------------------------------------------------------------------------

// Read a plan file into *plan, over what is there, for the techniques that are studied. Fails with BAD_ARGUMENT and a
// sentence that names the place in the file. The points are the caller's to free.
candil_status study_plan_read(const char *path, unsigned techniques, struct study_plan *plan, struct candil_error *error);
// A plan, and the settings of a point, as a file has them.
json_t *study_plan_json(const struct study_plan *plan);
json_t *study_settings_json(uint32_t samples, const struct study_setting *settings, uint32_t count);

// ---- study_options.c ------------------------------------------------------------------------------------------------

// Parse the command line into job.options, texts, techniques and the plan's first values. false: return *code.
bool study_options(struct study *study, struct cli *cli, const struct command *self, int argc, char **argv,
		   enum exit_code *code);

// ---- study_state.c --------------------------------------------------------------------------------------------------

// Make the folder, lock it, read runs.jsonl. Fails with BAD_ARGUMENT if it is not a study's, or another one works in it.
enum exit_code study_open_folder(struct study *study);
// Refuse, with BAD_ARGUMENT, a folder that has runs of another scene than the target's: they would go out of its report.
enum exit_code study_check_scene(struct study *study);
// Mark a run as done if it has a whole image under its name, and a line.
void study_find_run(struct study *study, struct study_run *run);
// Take all lines but those of runs that are done out of runs.jsonl. Good lines of other runs go to others.jsonl first.
enum exit_code study_prune(struct study *study);
// Write a file of an open folder, whole or not at all. A link of that name is replaced, not followed. false: errno says why.
bool study_save(const struct study *study, int folder, const char *name, const void *data, size_t bytes);
// What study.json says of the report that is there: made of what, and by which program. NULL: nothing. To be released.
json_t *study_read_report_of(const struct study *study);
// Set it there. The object is taken. false: study.json cannot be written.
bool study_write_report_of(const struct study *study, json_t *what);
// Append a line, and keep it in study->lines. The object is taken.
enum exit_code study_append(struct study *study, const char *id, json_t *line);
// Take the plan of plan.json if it was made for `key`. false: there is none.
bool study_read_own_plan(struct study *study, const char *key);
enum exit_code study_write_plan(struct study *study);
// false: errno says why study.json cannot be written.
bool study_write_state(struct study *study);
// Whether study.json says that all is there.
bool study_is_ended(const struct study *study);
// Runs that are not there, [{"run", "why"}], and techniques without a run, [{"technique", "why"}].
json_t *study_missing_json(const struct study *study);
json_t *study_skipped_json(const struct study *study);

// ---- study_request.c ------------------------------------------------------------------------------------------------

// The point of a run; NULL of a reference.
const struct study_point *study_point_of(const struct study *study, const struct study_run *run);
// Set the camera of a view. Returns its word in a report.
const char *study_choose_camera(const struct study *study, const struct study_view *view,
				struct candil_render_request *request);
// Fill in job.options.request for a run. `options`: room for its settings.
void study_request(struct study *study, const struct study_run *run, struct candil_option options[STUDY_SETTINGS_MAX]);
// The command line that makes the run's image again. false: it does not fit.
bool study_command_line(const struct study *study, const struct study_run *run, char *text, size_t capacity);

// ---- study_list.c ---------------------------------------------------------------------------------------------------

// Fill in a run and its id.
void study_make_run(struct study *study, enum study_kind kind, uint32_t view, uint32_t point, uint64_t seed,
		    struct study_run *run);
// List all runs of the plan: cold ones of points with noise, references, then turns. In each turn every point with noise
// comes once, in an order of its own, so that a machine that is busy for a while is so for all. A series without noise comes
// in the first turn, cold, then with all its repeats, its counts of samples by turns: they use what the cold run has made of
// the scene, which a run of any other settings would throw away. false: too many, or no memory.
bool study_list_runs(struct study *study);

// ---- study_time.c ---------------------------------------------------------------------------------------------------

// Seconds of N samples of a technique's defaults: a + b N.
struct study_line {
	double a, b;
	bool known; // something was measured
};
struct study_line study_line_of(const struct study *study, unsigned technique, uint32_t view);
// Seconds that a warm run of the point will take, its cold one, and a view's reference.
double study_predict(const struct study *study, uint32_t point, uint32_t view);
double study_predict_cold(const struct study *study, uint32_t point, uint32_t view);
double study_predict_reference(const struct study *study, uint32_t view);
// Seconds that the runs take which are not done.
double study_left(const struct study *study);
// Seconds that candil-report will take.
double study_predict_report(const struct study *study);

// ---- study_say.c ----------------------------------------------------------------------------------------------------

// Print the plan, if some of it is left.
void study_say_plan(struct study *study);
void study_say_progress(struct study *study, const struct study_run *run);
enum exit_code study_say_end(struct study *study);

// ---- study_runner.c -------------------------------------------------------------------------------------------------

// Make a run if it is not done, and write its line; a failure of the run is a line, too. Anything else than EXIT_DONE ends
// the session, and is printed.
enum exit_code study_make(struct study *study, struct study_run *run);

// ---- study_report.c -------------------------------------------------------------------------------------------------

// Run candil-report unless the report that is there was made by the same program of the same runs.
void study_make_report(struct study *study);

// ---- study_fit.c ----------------------------------------------------------------------------------------------------

// Measure the scene, and settle the plan: no point has STUDY_SAMPLES_FIT afterwards, every view its reference.
enum exit_code study_fit(struct study *study);

#endif
