// Shared objects that are linked when they are needed. Any thread.
#ifndef CANDIL_BASE_LIBRARY_H
#define CANDIL_BASE_LIBRARY_H

#include "server/base/error.h"

// Link the shared object `file`, which lies beside this program, and find `symbol` in it; it stays linked. No search path is
// asked, for what lies in the current folder may be anybody's. `flags` are dlopen's. NULL on failure: `code`, with what the
// linker says.
void *library_symbol(const char *file, int flags, const char *symbol, enum status code, struct error *err);

// Say on standard error that `program` lacks one, as the dynamic linker does, and return its exit status for that.
int library_missing(const char *program, const struct error *err);

#endif
