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

// Does errno tell of no room on the disk, in the quota, or below the limit? Not every file system can say beforehand.
static bool is_full(void)
{
	return errno == ENOSPC || errno == EDQUOT || errno == EFBIG;
}

static bool reserve(int fd, off_t bytes)
{
	return fallocate(fd, 0, 0, bytes) == 0 || !is_full();
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
	struct temporary t;
	bool good = temporary_open(&t, AT_FDCWD, folder, 0600);
	if (good && t.name[0] && unlinkat(t.folder, t.name, 0) == 0) // so that a kill leaves nothing
		t.name[0] = '\0';
	good = good ? reserve(t.fd, ROOM_BYTES) : !is_full();
	temporary_finish(&t);
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
