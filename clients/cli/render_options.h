// The command lines of `candil render`, `candil sweep`, `candil quote`, `candil inspect` and `candil study`, parsed.
#ifndef CANDIL_CLI_RENDER_OPTIONS_H
#define CANDIL_CLI_RENDER_OPTIONS_H

#include "clients/cli/cli.h"
#include "clients/cli/edit_options.h"

struct render_options {
	const char *scene;
	const char *output; // "-": standard output; NULL: a quote that names none
	bool quiet;
	struct candil_render_request request; // all but `scene`; strings point into argv
	struct candil_load_request load; // only `up` and `metres_per_unit`
	struct candil_option settings[16]; // what request.options points at
	struct edit_options edits; // what request.edits points at
	uint32_t pilot_ms; // of a quote; 0: not given
};

// What only `candil sweep` takes, as text, which sweep.c parses. NULL: not given.
struct sweep_texts {
	const char *orbit, *cameras, *keys, *frames, *fps, *shard;
	bool force;
};

// Parse the command line of `candil render`. true: *options is filled in. false: return *code from the command. Writes into
// argv to split NAME=VALUE. The samples are 0, the daemon's default, without --spp.
bool render_options_parse(struct cli *cli, const struct command *self, int argc, char **argv, struct render_options *options,
			  enum exit_code *code);

// The same for `candil sweep`, which does not take --at and --progressive. The samples are never 0.
bool sweep_options_parse(struct cli *cli, const struct command *self, int argc, char **argv, struct render_options *options,
			 struct sweep_texts *texts, enum exit_code *code);

// The same for `candil quote`, which needs no output, and of one takes the format alone.
bool quote_options_parse(struct cli *cli, const struct command *self, int argc, char **argv, struct render_options *options,
			 enum exit_code *code);

// The same for `candil inspect`, whose output is the beginning of its files' names. The defaults are PNG, one sample and the
// technique that has voxels.
bool inspect_options_parse(struct cli *cli, const struct command *self, int argc, char **argv,
			   struct render_options *options, enum exit_code *code);

// Who sees an option of the command line, its name and its text before anything is cut off it; NULL: it has none. true: the
// option is the watcher's own, and the parser takes nothing of it.
struct option_watch {
	bool (*take)(void *user, const char *name, const char *value);
	void *user;
};

// The same for `candil study`, whose output is a folder. Its own options, and --camera, are the watcher's.
bool study_options_parse(struct cli *cli, const struct command *self, int argc, char **argv, struct render_options *options,
			 const struct option_watch *watch, enum exit_code *code);

#endif
