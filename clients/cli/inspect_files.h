// The files of `candil inspect` that are no pictures: patches, and their form factors.
#ifndef CANDIL_CLI_INSPECT_FILES_H
#define CANDIL_CLI_INSPECT_FILES_H

#include "clients/cli/inspect_say.h"

// Options that a request has room for.
#define INSPECT_SETTINGS (sizeof(((struct inspect *)0)->job.options.settings) / sizeof(struct candil_option))

// Copy the user's options, but for one that only the picture of a row takes, unless `show` is that. Returns how many.
size_t inspect_settings(const struct inspect *inspect, const char *show, struct candil_option *options);

// Make the files, which have their names (inspect_name_files). One that would be too large is told in the answer, and the
// other is made all the same. Any other failure is printed, and ends it.
enum exit_code inspect_make_files(struct inspect *inspect);

// What the command ends with if all else went well.
enum exit_code inspect_files_exit_code(const struct inspect *inspect);

#endif
