// A file appears under its name whole or not at all: it is written beside its place and renamed. Any thread.
#ifndef CANDIL_BASE_REPLACE_H
#define CANDIL_BASE_REPLACE_H

#include <stddef.h>

#include "server/base/error.h"

// Write a file, or replace the one that is there; of a link the link. STATUS_IO, STATUS_MEMORY: what was there stays.
enum status replace_file(const char *path, const void *data, size_t bytes, struct error *err);

// A name beside `path`, to be freed, that a library writes to before replace_commit; NULL: no memory. It ends as `path`
// does.
char *replace_begin(const char *path);

// Move `temporary` to `path`. On failure, STATUS_IO, it is removed. replace_abandon removes it.
enum status replace_commit(const char *temporary, const char *path, struct error *err);
void replace_abandon(const char *temporary);

#endif
