#include "server/base/library.h"

#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

void *library_symbol(const char *file, int flags, const char *symbol, enum status code, struct error *err)
{
	char path[PATH_MAX];
	const ssize_t length = readlink("/proc/self/exe", path, sizeof path - 1);
	if (length <= 0) {
		error_errno(err, code, "%s: cannot tell where this program lies", file);
		return NULL;
	}
	path[length] = '\0';
	char *name = strrchr(path, '/') + 1;
	const size_t room = sizeof path - (size_t)(name - path);
	if (strlen(file) >= room) {
		error_set(err, code, "%s: its path is too long", file);
		return NULL;
	}
	memcpy(name, file, strlen(file) + 1);
	void *library = dlopen(path, flags);
	void *found = library ? dlsym(library, symbol) : NULL;
	if (!found)
		error_set(err, code, "%.200s", dlerror());
	return found;
}

int library_missing(const char *program, const struct error *err)
{
	fprintf(stderr, "%s: error while loading shared libraries: %s\n", program, err->text);
	return 127;
}
