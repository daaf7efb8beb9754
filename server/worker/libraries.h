// Where a shared object and those that it needs lie, from its own lists of folders (DT_RUNPATH, DT_RPATH): what a driver or
// the codec links late, once the fence is up. Nothing is linked for that. One thread.
#ifndef CANDIL_WORKER_LIBRARIES_H
#define CANDIL_WORKER_LIBRARIES_H

#include "server/base/landlock.h"

// Allow reading the folder of the shared object at `path`, and the folders that it and what it needs from there name. Of the
// root, of what lies right beneath it, and of a home or what homes lie in, not the folder is allowed but each object that is
// found there. A file that is none, or none of this machine's kind, is passed over; so is what lies deeper than eight of
// them.
void libraries_allow(struct landlock *l, const char *path);

#endif
