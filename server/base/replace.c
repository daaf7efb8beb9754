#include "server/base/replace.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/place.h"

enum status replace_file(const char *path, mode_t mode, const void *data, size_t bytes, struct error *err)
{
	const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
	char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
	struct temporary temporary;
	struct stat about;
	enum status s = STATUS_OK;
	if (!folder)
		return error_set(err, STATUS_MEMORY, "no memory to write %s", path);
	bool good = temporary_open(&temporary, AT_FDCWD, folder, mode) && place_write_all(temporary.fd, data, bytes);
	// Of another owner's file the owner may not be had: then this program's file takes its place.
	if (good && lstat(path, &about) == 0 && S_ISREG(about.st_mode))
		(void)temporary_keep(&temporary, &about);
	good = good && temporary_place(&temporary, -1, name);
	temporary_finish(&temporary);
	if (!good)
		s = error_errno(err, STATUS_IO, "cannot write %s", path);
	free(folder);
	return s;
}

// What is no regular file has no place that another could take.
static bool write_special(const char *path, const void *data, size_t bytes)
{
	const int fd = open(path, O_WRONLY | O_NOCTTY | O_CLOEXEC);
	return fd >= 0 && place_close_written(fd, place_write_all(fd, data, bytes));
}

enum status replace_asked(const char *path, const void *data, size_t bytes, struct error *err)
{
	struct stat about;
	struct place place = PLACE_NONE;
	const bool special = stat(path, &about) == 0 && !S_ISREG(about.st_mode) && !S_ISDIR(about.st_mode);
	const bool good =
	    special ? write_special(path, data, bytes) : place_open(&place, path) && place_write(&place, data, bytes);
	place_close(&place);
	return good ? STATUS_OK : error_errno(err, STATUS_IO, "cannot write %s", path);
}
