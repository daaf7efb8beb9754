// The options that say how a file is to be read: --up and --unit.
#ifndef CANDIL_CLI_SCENE_OPTIONS_H
#define CANDIL_CLI_SCENE_OPTIONS_H

#include "clients/cli/cli.h"

enum { OPTION_UP = 1100, OPTION_UNIT };
#define SCENE_OPTIONS \
	{"up", required_argument, NULL, OPTION_UP}, \
	{ \
		"unit", required_argument, NULL, OPTION_UNIT \
	}

// Take one of the two. false: the text is not an axis, or not a length above 0.
bool scene_option(int option, const char *text, struct candil_load_request *request);

// What the option takes, for a sentence.
const char *scene_option_form(int option);

// Print that `text` is not what the option takes. Returns EXIT_USAGE.
enum exit_code scene_option_refuse(const struct command *self, int option, const char *text);

// Whether either was given.
bool scene_options_given(const struct candil_load_request *request);

// false: one of them was given for a glTF file, which states its own axes and unit.
bool scene_options_fit(const char *file, const struct candil_load_request *request);
#define SCENE_OPTIONS_ARE_FOR_OBJ \
	"--up and --unit are for OBJ files; a glTF file states its own axes, and its unit is the metre"

#endif
