#include "server/base/replace.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

char *replace_begin(const char *path)
{
	const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
	char *temporary = NULL;
	return asprintf(&temporary, "%.*s.%ld-%s", (int)(name - path), path, (long)getpid(), name) < 0 ? NULL : temporary;
}

enum status replace_commit(const char *temporary, const char *path, struct error *err)
{
	if (rename(temporary, path) == 0)
		return STATUS_OK;
	const enum status s = error_errno(err, STATUS_IO, "cannot write %s", path);
	unlink(temporary);
	return s;
}

void replace_abandon(const char *temporary)
{
	unlink(temporary);
}

enum status replace_file(const char *path, const void *data, size_t bytes, struct error *err)
{
	char *temporary = replace_begin(path);
	if (!temporary)
		return error_set(err, STATUS_MEMORY, "no memory to write %s", path);
	enum status s = STATUS_OK;
	FILE *file = fopen(temporary, "wbe");
	if (!file || fwrite(data, 1, bytes, file) != bytes)
		s = error_errno(err, STATUS_IO, "cannot write %s", path);
	if (file && fclose(file) != 0 && s == STATUS_OK)
		s = error_errno(err, STATUS_IO, "cannot write %s", path);
	if (s == STATUS_OK)
		s = replace_commit(temporary, path, err);
	else
		replace_abandon(temporary);
	free(temporary);
	return s;
}
