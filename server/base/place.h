// The place of a file that a user asked for by its path. The file appears there whole or not at all: it is written without a
// name (temporary.h) and takes the place of what was there, whose owner and mode it gets; other hard links keep what was
// there. Of a link what it leads to is replaced, and the link itself if it leads nowhere. What this user may not write to is
// refused, although it could be replaced: its owner does not want that. Where nothing can be replaced, because the folder is
// not ours to write to, the owner's name cannot be given, or something is mounted there, an existing file is written over.
// Any thread. Failures are told by errno.
#ifndef CANDIL_BASE_PLACE_H
#define CANDIL_BASE_PLACE_H

#include <stdbool.h>
#include <stddef.h>

#include "server/base/temporary.h"

struct place {
	char *path; // with links resolved; NULL: none
	struct temporary temporary; // of the next file
	bool can_replace; // a better file can take the place of the first
};

#define PLACE_NONE \
	{ \
		.temporary = TEMPORARY_NONE \
	}

// Find out whether a regular file can be written there, be it one that is there already. false: it cannot. place_close is
// due in any case.
bool place_open(struct place *place, const char *path);

// Write the file. If can_replace, it may be called again with a better one. false: what was there stays, if can_replace.
bool place_write(struct place *place, const void *data, size_t bytes);

// Drop what has no name yet and free everything. errno stays as it is.
void place_close(struct place *place);

// Write all bytes to an open file, however many calls that takes.
bool place_write_all(int fd, const void *data, size_t bytes);

// Close a descriptor that was written to. false: that failed, or the writing had, as `good` says.
bool place_close_written(int fd, bool good);

#endif
