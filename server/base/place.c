#include "server/base/place.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool open_temporary(struct place *place)
{
	char *copy = strdup(place->path);
	struct stat about;
	if (!copy)
		return false;
	bool good = temporary_open(&place->temporary, AT_FDCWD, dirname(copy), 0666);
	if (good && stat(place->path, &about) == 0)
		good = temporary_keep(&place->temporary, &about);
	if (!good)
		temporary_finish(&place->temporary);
	free(copy);
	return good;
}

bool place_open(struct place *place, const char *path)
{
	struct stat about;
	*place = (struct place)PLACE_NONE;
	const bool there = stat(path, &about) == 0;
	if (there && S_ISDIR(about.st_mode)) {
		errno = EISDIR;
		return false;
	}
	place->path = there ? realpath(path, NULL) : strdup(path);
	if (!place->path || (there && access(place->path, W_OK) != 0))
		return false;
	place->can_replace = open_temporary(place);
	return place->can_replace || there;
}

bool place_write_all(int fd, const void *data, size_t bytes)
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

bool place_close_written(int fd, bool good)
{
	const int failure = errno;
	const bool closed = close(fd) == 0;
	if (!good)
		errno = failure;
	return good && closed;
}

static bool write_over(const char *path, const void *data, size_t bytes)
{
	const int fd = open(path, O_WRONLY | O_TRUNC | O_NOFOLLOW | O_CLOEXEC);
	return fd >= 0 && place_close_written(fd, place_write_all(fd, data, bytes));
}

static bool replace(struct place *place, const void *data, size_t bytes)
{
	const char *slash = strrchr(place->path, '/');
	if (place->temporary.fd < 0 && !open_temporary(place))
		return false;
	const bool good = place_write_all(place->temporary.fd, data, bytes) &&
			  temporary_place(&place->temporary, -1, slash ? slash + 1 : place->path);
	temporary_finish(&place->temporary);
	return good || (errno == EBUSY && write_over(place->path, data, bytes)); // something is mounted there
}

bool place_write(struct place *place, const void *data, size_t bytes)
{
	return place->can_replace ? replace(place, data, bytes) : write_over(place->path, data, bytes);
}

void place_close(struct place *place)
{
	const int failure = errno;
	temporary_finish(&place->temporary);
	free(place->path);
	*place = (struct place)PLACE_NONE;
	errno = failure;
}
