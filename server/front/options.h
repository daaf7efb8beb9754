// The daemon's command line.
#ifndef CANDIL_FRONT_OPTIONS_H
#define CANDIL_FRONT_OPTIONS_H

#include <limits.h>
#include <stdbool.h>
#include <stdint.h>

#include "server/base/error.h"

struct scene_option {
	char name[LIMIT_NAME + 1];
	const char *file; // of argv
	bool warm; // the daemon listens when its pictures come quickly
};

struct options {
	char socket[PATH_MAX]; // "": none is made (private connection)
	char libexec[PATH_MAX]; // where candil-loader and candil-worker are
	char state[PATH_MAX]; // a folder for what is learned; "": none
	bool no_state;
	const char *scene_root; // NULL: none
	const char *device;
	bool require_gpu;
	uint32_t memory_budget_mib; // 0: the worker's choice
	uint32_t slice_ms;
	uint32_t hang_s; // that a child may be still (pulse.h); 0: the usual
	uint32_t answer_s; // that the worker may work on one order
	int private_fd; // -1: none
	struct scene_option scenes[LIMIT_SCENES];
	unsigned scene_count;
	bool help, version; // print and leave
};

// Read the command line and fill in the defaults. The pointers in `options` point into argv. Not from two threads at once:
// getopt_long has a state. Failures, with a sentence for the user: STATUS_BAD_ARGUMENT, STATUS_TOO_MANY_SCENES,
// STATUS_INTERNAL.
enum status options_parse(struct options *options, int argc, char *const argv[], struct error *err);

// The text of --help.
const char *options_help(void);

#endif
