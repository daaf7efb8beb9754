// A file on its way to its name: it is written without one, so that nothing of it is left behind if the program is killed,
// and then appears under its name whole, in the place of what was there. Where the file system has no such files it is
// written beside its place, as .candil-PID-N.tmp, and what takes another's place has that name for a moment. A kill may
// leave it; the next process of this user whose first replaced file is there removes it, once it is a week old and if nobody
// has it open any more. Any thread. Failures are told by errno.
//
// Example:
//	struct temporary t;
//	bool good = temporary_open(&t, AT_FDCWD, "folder", 0666) && write(t.fd, "text", 4) == 4;
//	good = good && temporary_place(&t, -1, "name");
//	temporary_finish(&t);
#ifndef CANDIL_BASE_TEMPORARY_H
#define CANDIL_BASE_TEMPORARY_H

#include <stdbool.h>
#include <sys/stat.h>

struct temporary {
	int folder; // the temporary's own; -1: none
	int fd; // to write to, locked (flock); -1: none
	char name[48]; // in the folder; "": it has none
};

// Since it was written, from when on what a kill has left goes. A lock tells what is still in use; this is for what lies
// where locks do not reach other machines, and longer than a render takes.
#define TEMPORARY_STALE_SECONDS 604800

#define TEMPORARY_NONE \
	{ \
		.folder = -1, .fd = -1 \
	}

// Make one in the folder `path`, seen from the open folder `at` (AT_FDCWD: where the program is). `mode` is before the
// umask. temporary_finish is due in any case.
bool temporary_open(struct temporary *t, int at, const char *path, mode_t mode);

// Give it the owner, the group and the mode of the file that it is to replace. Set-user-ID and the like are not taken over.
bool temporary_keep(const struct temporary *t, const struct stat *replaced);

// Put it under `name`, without a slash, into the open folder `into` of the same file system; -1: its own. A link of that
// name is replaced, not followed.
bool temporary_place(struct temporary *t, int into, const char *name);

// Close it; what was not placed goes. errno stays as it is.
void temporary_finish(struct temporary *t);

#endif
