#include "server/base/replace.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/temporary.h"

static bool write_all(int fd, const uint8_t *data, size_t bytes)
{
	while (bytes > 0) {
		const ssize_t sent = write(fd, data, bytes);
		if (sent < 0 && errno == EINTR)
			continue;
		if (sent <= 0)
			return false;
		data += sent;
		bytes -= (size_t)sent;
	}
	return true;
}

enum status replace_file(const char *path, mode_t mode, const void *data, size_t bytes, struct error *err)
{
	const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
	char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
	struct temporary temporary;
	struct stat about;
	enum status s = STATUS_OK;
	if (!folder)
		return error_set(err, STATUS_MEMORY, "no memory to write %s", path);
	bool good = temporary_open(&temporary, AT_FDCWD, folder, mode) && write_all(temporary.fd, data, bytes);
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
