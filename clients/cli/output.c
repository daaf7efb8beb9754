#include "clients/cli/output.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <string.h>
#include <unistd.h>

#include "clients/cli/interrupt.h"

#define LOOK_MS 20 // between two looks whether a pipe has a reader
#define LONG_MS 3600000

// Open what is no regular file. A pipe without a reader cannot be opened in any other way that an interrupt ends.
static bool open_special(struct output *output, const char *path, bool pipe)
{
	for (;;) {
		output->fd = open(path, O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
		if (output->fd >= 0 || errno != ENXIO || !pipe)
			return output->fd >= 0;
		if (interrupt_seen())
			break;
		interrupt_pause(LOOK_MS);
	}
	errno = ECANCELED;
	return false;
}

bool output_open(struct output *output, const char *path)
{
	struct stat about;
	*output = (struct output)OUTPUT_NONE;
	if (strcmp(path, "-") == 0) {
		output->fd = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
		return output->fd >= 0;
	}
	if (stat(path, &about) != 0 || S_ISREG(about.st_mode) || S_ISDIR(about.st_mode))
		return place_open(&output->place, path);
	// Links to pipes and the like lead nowhere that realpath could follow.
	return open_special(output, path, S_ISFIFO(about.st_mode));
}

// Wait until the reader has made room. false: an interrupt came before that, and there is none.
static bool wait_for_room(int fd)
{
	struct pollfd p = {fd, POLLOUT, 0};
	int ready;
	while ((ready = interrupt_poll(&p, 1, interrupt_seen() ? 0 : LONG_MS)) <= 0) {
		if (ready < 0 && errno != EINTR)
			return false;
		if (interrupt_seen()) {
			errno = ECANCELED;
			return false;
		}
	}
	return true;
}

// Write to a pipe whose reader may have stopped. As much as is written at once fits where there is any room, so that a
// descriptor which others share, and which therefore waits, does not wait.
static bool write_special(int fd, const void *data, size_t bytes)
{
	const char *next = data;
	while (bytes > 0) {
		if (!wait_for_room(fd))
			return false;
		const ssize_t written = write(fd, next, bytes < PIPE_BUF ? bytes : PIPE_BUF);
		if (written < 0 && errno != EINTR && errno != EAGAIN)
			return false;
		next += written > 0 ? written : 0;
		bytes -= written > 0 ? (size_t)written : 0;
	}
	return true;
}

bool output_write(struct output *output, const void *data, size_t bytes)
{
	bool good;
	if (output->fd >= 0) {
		good = place_close_written(output->fd, write_special(output->fd, data, bytes));
		output->fd = -1;
	} else {
		good = place_write(&output->place, data, bytes);
	}
	output->count += good;
	return good;
}

void output_close(struct output *output)
{
	const int failure = errno;
	if (output->fd >= 0)
		close(output->fd);
	place_close(&output->place);
	*output = (struct output)OUTPUT_NONE;
	errno = failure;
}

bool output_save(const char *path, const void *data, size_t bytes)
{
	struct output output;
	const bool good = output_open(&output, path) && output_write(&output, data, bytes);
	output_close(&output);
	return good;
}

bool output_probe(const char *path)
{
	struct output output;
	struct stat about;
	// To open a pipe and close it again would be the end of the file to its reader.
	if (stat(path, &about) == 0 && !S_ISREG(about.st_mode) && !S_ISDIR(about.st_mode))
		return access(path, W_OK) == 0;
	const bool good = output_open(&output, path);
	output_close(&output);
	return good;
}
