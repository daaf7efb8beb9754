#include "clients/cli/output.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// Make a new file in the folder of the output.
static bool open_temporary(struct output *output)
{
	char *copy = strdup(output->path);
	if (!copy)
		return false;
	const char *folder = dirname(copy);
	for (unsigned i = 0; i < 100 && output->fd < 0; i++) {
		free(output->temporary);
		if (asprintf(&output->temporary, "%s/.candil-%ld-%u.tmp", folder, (long)getpid(), output->count + i) < 0) {
			output->temporary = NULL;
			break;
		}
		output->fd = open(output->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
		if (output->fd < 0 && errno != EEXIST)
			break;
	}
	if (output->fd < 0) {
		int failure = errno;
		free(output->temporary);
		output->temporary = NULL;
		errno = failure;
	}
	int failure = errno;
	free(copy);
	errno = failure;
	return output->fd >= 0;
}

bool output_open(struct output *output, const char *path)
{
	struct stat about;
	*output = (struct output){.fd = -1};
	if (strcmp(path, "-") == 0) {
		output->fd = dup(STDOUT_FILENO);
		return output->fd >= 0;
	}
	bool there = stat(path, &about) == 0;
	output->path = there ? realpath(path, NULL) : strdup(path);
	if (!output->path)
		return false;
	if (there && S_ISDIR(about.st_mode)) {
		errno = EISDIR;
		return false;
	}
	if (there && !S_ISREG(about.st_mode)) {
		output->fd = open(output->path, O_WRONLY | O_CLOEXEC);
		return output->fd >= 0;
	}
	// A read-only file could be replaced, but its owner does not want that.
	if (there && access(output->path, W_OK) != 0)
		return false;
	output->can_replace = true;
	return open_temporary(output);
}

bool output_write_all(int fd, const void *data, size_t bytes)
{
	const char *next = data;
	while (bytes > 0) {
		ssize_t written = write(fd, next, bytes);
		if (written < 0 && errno == EINTR)
			continue;
		if (written < 0)
			return false;
		next += written;
		bytes -= (size_t)written;
	}
	return true;
}

bool output_write(struct output *output, const void *data, size_t bytes)
{
	if (output->fd < 0 && !(output->can_replace && open_temporary(output)))
		return false;
	bool good = output_write_all(output->fd, data, bytes);
	int failure = errno;
	if (close(output->fd) != 0 && good) {
		good = false;
		failure = errno;
	}
	output->fd = -1;
	if (good && output->temporary && rename(output->temporary, output->path) != 0) {
		good = false;
		failure = errno;
	}
	if (!good && output->temporary)
		unlink(output->temporary);
	free(output->temporary);
	output->temporary = NULL;
	output->count += good;
	errno = failure;
	return good;
}

void output_close(struct output *output)
{
	if (output->fd >= 0)
		close(output->fd);
	if (output->temporary)
		unlink(output->temporary);
	free(output->temporary);
	free(output->path);
	*output = (struct output){.fd = -1};
}

// Call output_close, and leave errno as it was.
static bool output_closed(struct output *output, bool good)
{
	const int failure = errno;
	output_close(output);
	errno = failure;
	return good;
}

bool output_save(const char *path, const void *data, size_t bytes)
{
	struct output output;
	return output_closed(&output, output_open(&output, path) && output_write(&output, data, bytes));
}

bool output_probe(const char *path)
{
	struct output output;
	return output_closed(&output, output_open(&output, path));
}
