// What `candil inspect` has in hand, and how it tells of it.
#ifndef CANDIL_CLI_INSPECT_SAY_H
#define CANDIL_CLI_INSPECT_SAY_H

#include <limits.h>

#include "clients/cli/inspect_pictures.h"
#include "clients/cli/job.h"
#include "protocol/limits.h"

// Options that a picture adds to those of --set. Of patches it is the first alone.
enum { OWN_SHOW, OWN_LEVEL, OWN_AXIS, OWN_SLICE, OWN_OPTIONS };

// The files of patches that are no pictures, in the order in which they are made.
enum { FILE_PATCHES, FILE_FACTORS, FILES };

struct inspect_file {
	char name[PATH_MAX]; // "PREFIX-patches.ply"
	uint64_t bytes; // 0: it is not written
	int failure; // errno of writing it
	struct candil_error error; // why it is not made
	struct candil_done done;
};

struct inspect {
	struct job job;
	bool patches; // these are looked into; else voxels
	bool lacks_factors; // of patches: what is imported is a solution, which has none to show
	struct inspect_list list;
	uint32_t done; // pictures that are written
	struct inspect_file files[FILES];
	uint32_t file; // that is being made
	bool framed; // the scene has no camera
	char own[OWN_OPTIONS][LIMIT_OPTION_NAME + 1]; // names of the own options: the technique's name, a dot, a word
	char row[LIMIT_OPTION_NAME + 1]; // of patches, the option that only the picture of a row takes
	char wrong[256]; // the sentence that says what inspect cannot take
};

// How many of the files that are no pictures are made.
uint32_t inspect_file_count(const struct inspect *inspect);

// The extension of the pictures' files.
const char *inspect_extension(const struct inspect *inspect);

// Make the names of the files that are no pictures. false: they do not fit, and errno says so.
bool inspect_name_files(struct inspect *inspect);

// The answer as an object, and as lines on standard output.
json_t *inspect_answer_json(const struct inspect *inspect);
void inspect_print_answer(const struct inspect *inspect);

// Print, on standard error, which files were not made and why.
void inspect_print_lacking(const struct inspect *inspect);

#endif
