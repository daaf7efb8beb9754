// What `candil inspect` has in hand, and how it tells of it.
#ifndef CANDIL_CLI_INSPECT_SAY_H
#define CANDIL_CLI_INSPECT_SAY_H

#include "clients/cli/inspect_pictures.h"
#include "clients/cli/job.h"
#include "protocol/limits.h"

// Options that a picture adds to those of --set. Of patches it is the first alone.
enum { OWN_SHOW, OWN_LEVEL, OWN_AXIS, OWN_SLICE, OWN_OPTIONS };

struct inspect {
	struct job job;
	bool patches; // these are looked into; else voxels
	struct inspect_list list;
	uint32_t done; // pictures that are written
	bool framed; // the scene has no camera
	char own[OWN_OPTIONS][LIMIT_OPTION_NAME + 1]; // names of the own options: the technique's name, a dot, a word
	char row[LIMIT_OPTION_NAME + 1]; // of patches, the option that only the picture of a row takes
	char wrong[256]; // the sentence that says what inspect cannot take
};

// The extension of the pictures' files.
const char *inspect_extension(const struct inspect *inspect);

// The answer as an object, and as lines on standard output.
json_t *inspect_answer_json(const struct inspect *inspect);
void inspect_print_answer(const struct inspect *inspect);

#endif
