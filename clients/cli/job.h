// What the commands that make pictures share (render, sweep, inspect): their options, the scene, the daemon, the bar, and
// how a request is seen through to its end.
//
//   job_begin, job_open, (submit, job_follow)*, job_end; every failure is said by job_fail or job_fail_output
#ifndef CANDIL_CLI_JOB_H
#define CANDIL_CLI_JOB_H

#include "clients/cli/progress.h"
#include "clients/cli/render_options.h"
#include "clients/cli/target.h"

struct job {
	const struct cli *cli;
	FILE *stream; // where the answer goes, and with --json failures
	struct render_options options; // parsed
	const char *output; // the file that is being written: job_follow names it if that fails
	struct target target;
	struct progress progress;
};

// Fill in what the options do not, and hold Ctrl-C back for interrupt_wait. job_end, due in any case, is the end of both.
void job_begin(struct job *job);
void job_end(struct job *job);

// Say a failure, on a line of its own, and give the command's exit code.
enum exit_code job_fail(struct job *job, const struct candil_error *error);
enum exit_code job_fail_output(struct job *job, const char *name); // it cannot be written; errno says why

// Find a daemon and the scene, and the picture of its surroundings; says so and fails if there is none. Once is enough.
enum exit_code job_open(struct job *job);

// Hand each event of request `id`, but a failure, to `take` until it ends. `take` false: `output` cannot be written, errno
// says why; then, as after an interrupt, the daemon is asked to cancel, and the end is waited for.
enum exit_code job_follow(struct job *job, uint32_t id, bool (*take)(void *user, const struct candil_event *event),
			  void *user);

// An interrupt came while no request was under way: the failure that says so.
enum exit_code job_fail_between(struct job *job);

#endif
