// What the commands that make pictures share (render, sweep, inspect): their options, the scene, the daemon, the progress
// bar, and how a request is seen through to its end. The order of the calls:
//
//	job_begin, job_open, (submit a request, job_follow) as often as needed, job_end
//
// job_fail and its relatives print every failure.
#ifndef CANDIL_CLI_JOB_H
#define CANDIL_CLI_JOB_H

#include "clients/cli/progress.h"
#include "clients/cli/render_options.h"
#include "clients/cli/target.h"

struct job {
	const struct cli *cli;
	FILE *stream; // where the answer goes, and with --json failures
	struct render_options options; // parsed
	const char *output; // the file that is being written, which job_follow names if that fails
	struct target target;
	struct progress progress;
	bool is_accepted; // a request was
	struct candil_accepted accepted; // the first that was
};

// Begin a job whose options are parsed, and hold interrupts back (interrupt.h). job_end must follow in any case: before the
// answer is printed, so that one which nobody reads keeps neither a scene nor an interrupt. A second one does nothing.
void job_begin(struct job *job);
void job_end(struct job *job);

// Print a failure on a line of its own. Returns the exit code of the command.
enum exit_code job_fail(struct job *job, const struct candil_error *error);
// The same for an output that cannot be written; errno says why. After ECANCELED (output.h) the command was cancelled.
enum exit_code job_fail_output(struct job *job, const char *name);

// The same for an interrupt that came while no request was under way.
enum exit_code job_fail_between(struct job *job);

// Find a daemon, the scene, and what goes with it, or print why not. A second call does nothing.
enum exit_code job_open(struct job *job);

// Take the acceptance of a request. The first is kept, and its warnings about the scene are printed to stderr, also with
// --quiet, but not with --json: then job_put_warnings puts them into the answer.
void job_take_accepted(struct job *job, const struct candil_accepted *accepted);

// Put "warnings" and "warnings_more" into an answer; [] and 0 if no request was accepted.
void job_put_warnings(const struct job *job, json_t *answer);

// Hand each event of request `id` to `take`, until the request ends; print its failure. `take` returns false if `output`
// cannot be written, with errno: then, as after an interrupt, the daemon is asked to cancel, and the end is waited for.
enum exit_code job_follow(struct job *job, uint32_t id, bool (*take)(void *user, const struct candil_event *event),
			  void *user);

// The same without a word: returns how the request ended, and *error is why. A `take` that fails is a cancelled request.
candil_status job_await(struct job *job, uint32_t id, bool (*take)(void *user, const struct candil_event *event), void *user,
			struct candil_error *error);

#endif
