#include "server/worker/cache.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/base/temporary.h"

#define ROOM_BYTES (4 << 20)
#define INDEX "mesa_shader_cache/index" // beneath the folder

// Not every file system can say beforehand.
static bool reserve(int fd, off_t bytes)
{
	return fallocate(fd, 0, 0, bytes) == 0 || errno == EOPNOTSUPP || errno == ENOSYS;
}

static bool fill_index(const char *folder)
{
	char path[PATH_MAX];
	struct stat about;
	const int length = snprintf(path, sizeof path, "%s/" INDEX, folder);
	const int fd =
	    length > 0 && (size_t)length < sizeof path ? open(path, O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK) : -1;
	if (fd < 0)
		return true;
	const bool good = fstat(fd, &about) != 0 || !S_ISREG(about.st_mode) || about.st_size == 0 ||
			  about.st_size > ROOM_BYTES || reserve(fd, about.st_size);
	close(fd);
	return good;
}

bool cache_has_room(const char *folder)
{
	struct temporary temporary;
	const bool good = temporary_open(&temporary, AT_FDCWD, folder, 0600) && reserve(temporary.fd, ROOM_BYTES);
	temporary_finish(&temporary);
	return good && fill_index(folder);
}

void cache_fill_index(const char *folder)
{
	(void)fill_index(folder);
}

void cache_turn_off(void)
{
	setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
	setenv("MESA_GLSL_CACHE_DISABLE", "true", 1); // its name before Mesa 21.1
	setenv("__GL_SHADER_DISK_CACHE", "0", 1); // NVIDIA's
}
