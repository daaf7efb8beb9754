#include "server/base/replace.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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
	char *temporary = NULL;
	if (asprintf(&temporary, "%.*s.%ld-%s", (int)(name - path), path, (long)getpid(), name) < 0)
		return error_set(err, STATUS_MEMORY, "no memory to write %s", path);
	unlink(temporary); // left there by a process that was killed, or planted
	const int fd = open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
	enum status s = STATUS_OK;
	if (fd < 0 || !write_all(fd, data, bytes))
		s = error_errno(err, STATUS_IO, "cannot write %s", path);
	if (fd >= 0 && close(fd) != 0 && s == STATUS_OK)
		s = error_errno(err, STATUS_IO, "cannot write %s", path);
	if (s == STATUS_OK && rename(temporary, path) != 0)
		s = error_errno(err, STATUS_IO, "cannot write %s", path);
	if (s != STATUS_OK && fd >= 0)
		unlink(temporary);
	free(temporary);
	return s;
}
