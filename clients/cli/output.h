// The image file. It appears under its name whole or not at all: bytes go to a temporary file beside it, which is renamed.
// A path that is no regular file (a pipe, a device) is written to as it is; "-" is standard output.
#ifndef CANDIL_CLI_OUTPUT_H
#define CANDIL_CLI_OUTPUT_H

#include <stdbool.h>
#include <stddef.h>

struct output {
	char *path; // where links lead
	char *temporary; // NULL: bytes go to the path itself
	int fd; // open for the next image; -1: none
	bool can_replace; // another image can take the place of one
	unsigned count; // images written
};

// Find out whether the output can be written, by opening it. false: it cannot, errno says why.
bool output_open(struct output *output, const char *path);

// Write an image. May be called again, with a better one, if can_replace. false: errno says why; the image before stays.
bool output_write(struct output *output, const void *data, size_t bytes);

// Both at once, for an output that gets one image; and whether that would do, before there is one: output_open and no more.
bool output_save(const char *path, const void *data, size_t bytes);
bool output_probe(const char *path);

// Remove what is left over, free. Also after a failed output_open.
void output_close(struct output *output);

#endif
