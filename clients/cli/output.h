// An image file, in its place (server/base/place.h) whole or not at all. What is no regular file (a pipe, a device) is
// written to as it takes the bytes; "-" is standard output.
//
// An interrupt (interrupt.h) ends the wait for a pipe's reader: then a call fails with ECANCELED.
#ifndef CANDIL_CLI_OUTPUT_H
#define CANDIL_CLI_OUTPUT_H

#include <stdbool.h>
#include <stddef.h>

#include "server/base/place.h"

struct output {
	struct place place; // of a regular file
	int fd; // of what is no regular file; -1: none
	unsigned count; // images written
};

#define OUTPUT_NONE \
	{ \
		.fd = -1, .place = PLACE_NONE \
	}

// Open the output, and find out by that whether it can be written; of a pipe wait for a reader. false: it cannot, errno says
// why.
bool output_open(struct output *output, const char *path);

// Write an image. If place.can_replace, it may be called again with a better one. false: errno says why; the earlier image
// stays.
bool output_write(struct output *output, const void *data, size_t bytes);

// Open, write and close an output that gets one image. false: errno says why.
bool output_save(const char *path, const void *data, size_t bytes);

// Whether output_save could write there. false: errno says why. Leaves nothing behind.
bool output_probe(const char *path);

// Drop what has no name yet and free everything. Also due after a failed output_open.
void output_close(struct output *output);

#endif
