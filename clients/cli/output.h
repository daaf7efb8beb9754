// An image file. It appears under its name whole or not at all: bytes go to a temporary file beside it, which is renamed.
// A path that is no regular file (a pipe, a device) is written to directly; "-" is standard output.
#ifndef CANDIL_CLI_OUTPUT_H
#define CANDIL_CLI_OUTPUT_H

#include <stdbool.h>
#include <stddef.h>

struct output {
	char *path; // with links resolved
	char *temporary; // the path of the temporary file; NULL: bytes go to `path` itself
	int fd; // open for the next image; -1: none
	bool can_replace; // a better image can take the place of the first
	unsigned count; // images written
};

// Open the output, and find out by that whether it can be written. false: it cannot, errno says why.
bool output_open(struct output *output, const char *path);

// Write an image. If can_replace, it may be called again with a better one. false: errno says why; the earlier image stays.
bool output_write(struct output *output, const void *data, size_t bytes);

// Open, write and close an output that gets one image. false: errno says why.
bool output_save(const char *path, const void *data, size_t bytes);

// Whether output_save could write there. false: errno says why. Leaves nothing behind.
bool output_probe(const char *path);

// Write all bytes to an open file, however many calls that takes. false: errno says why.
bool output_write_all(int fd, const void *data, size_t bytes);

// Remove the temporary file and free everything. Also due after a failed output_open.
void output_close(struct output *output);

#endif
