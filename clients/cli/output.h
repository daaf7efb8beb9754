// An image file. It appears under its name whole or not at all: it is written without a name (server/base/temporary.h) and
// takes the place of what was there, whose owner and mode it gets; other hard links keep what was there. Where that cannot
// be, because the folder is not ours to write to, the owner's name cannot be given, or something is mounted there, an
// existing file is written over. What is no regular file (a pipe, a device) is written to as it takes the bytes; "-" is
// standard output.
//
// An interrupt (interrupt.h) ends the wait for a pipe's reader: then a call fails with ECANCELED.
#ifndef CANDIL_CLI_OUTPUT_H
#define CANDIL_CLI_OUTPUT_H

#include <stdbool.h>
#include <stddef.h>

#include "server/base/temporary.h"

struct output {
	char *path; // of a regular file with links resolved
	struct temporary temporary; // of the next image
	int fd; // of what is no regular file; -1: none
	bool can_replace; // a better image can take the place of the first
	unsigned count; // images written
};

#define OUTPUT_NONE \
	{ \
		.fd = -1, .temporary = TEMPORARY_NONE \
	}

// Open the output, and find out by that whether it can be written; of a pipe wait for a reader. false: it cannot, errno says
// why.
bool output_open(struct output *output, const char *path);

// Write an image. If can_replace, it may be called again with a better one. false: errno says why; the earlier image stays.
bool output_write(struct output *output, const void *data, size_t bytes);

// Open, write and close an output that gets one image. false: errno says why.
bool output_save(const char *path, const void *data, size_t bytes);

// Whether output_save could write there. false: errno says why. Leaves nothing behind.
bool output_probe(const char *path);

// Write all bytes to an open file, however many calls that takes. false: errno says why.
bool output_write_all(int fd, const void *data, size_t bytes);

// Drop what has no name yet and free everything. Also due after a failed output_open.
void output_close(struct output *output);

#endif
