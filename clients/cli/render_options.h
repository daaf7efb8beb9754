// The command line of `candil render`, parsed.
#ifndef CANDIL_CLI_RENDER_OPTIONS_H
#define CANDIL_CLI_RENDER_OPTIONS_H

#include "clients/cli/cli.h"
#include "clients/cli/edit_options.h"

struct render_options {
	const char *scene;
	const char *output; // "-": standard output
	bool quiet;
	struct candil_render_request request; // all but `scene`; strings point into argv
	struct candil_load_request load; // up and metres_per_unit
	struct candil_option settings[16]; // what request.options points at
	struct edit_options edits; // what request.edits points at
};

// What `candil sweep` takes besides, and as text: sweep.c knows what it means. NULL: not given.
struct sweep_texts {
	const char *orbit, *cameras, *keys, *frames, *fps, *shard;
	bool force;
};

// true: *options is filled in. false: return *code from the command. Writes into argv (splits NAME=VALUE).
bool render_options_parse(struct cli *cli, const struct command *self, int argc, char **argv, struct render_options *options,
			  enum exit_code *code);

// The same for `candil sweep`, which has one camera after the other, so that --camera, --progressive and "-" are refused.
bool sweep_options_parse(struct cli *cli, const struct command *self, int argc, char **argv, struct render_options *options,
			 struct sweep_texts *texts, enum exit_code *code);

// The same for `candil inspect`, whose output is what its files' names begin with: PNG unless --format says exr, one sample
// a pixel unless --spp does, and the technique that has voxels unless --technique names one.
bool inspect_options_parse(struct cli *cli, const struct command *self, int argc, char **argv,
			   struct render_options *options, enum exit_code *code);

#endif
