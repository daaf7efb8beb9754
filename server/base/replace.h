// A file appears under its name whole or not at all (temporary.h). Any thread.
#ifndef CANDIL_BASE_REPLACE_H
#define CANDIL_BASE_REPLACE_H

#include <stddef.h>
#include <sys/types.h>

#include "server/base/error.h"

// Write a file, or replace the one that is there; of a link the link. `mode` is a new file's, before the umask; one that is
// there keeps its own, and its owner where this process may give files to it. Other hard links keep what was there. No link
// of any name beside it is followed. STATUS_IO, STATUS_MEMORY: what was there stays.
enum status replace_file(const char *path, mode_t mode, const void *data, size_t bytes, struct error *err);

// Write a file that a user has asked for, by the rules of place.h. What is no regular file (a pipe, a device) is written to
// as it is. STATUS_IO.
enum status replace_asked(const char *path, const void *data, size_t bytes, struct error *err);

#endif
