#include "server/base/temporary.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

#define TRIES 100u // names that are taken, by processes that were killed or by somebody who plants them

static void make_name(struct temporary *t, unsigned i)
{
	snprintf(t->name, sizeof t->name, ".candil-%ld-%u.tmp", (long)getpid(), i);
}

// The path by which the kernel finds an open file that has no name.
static void make_path(const struct temporary *t, char path[32])
{
	snprintf(path, 32, "/proc/self/fd/%d", t->fd);
}

static bool open_unnamed(struct temporary *t, mode_t mode)
{
	char path[32];
	t->fd = openat(t->folder, ".", O_TMPFILE | O_WRONLY | O_CLOEXEC, mode);
	if (t->fd < 0)
		return false;
	make_path(t, path);
	if (access(path, F_OK) == 0)
		return true;
	close(t->fd); // without /proc it would never get a name
	t->fd = -1;
	return false;
}

bool temporary_open(struct temporary *t, int at, const char *path, mode_t mode)
{
	*t = (struct temporary){.fd = -1, .folder = openat(at, path, O_PATH | O_DIRECTORY | O_CLOEXEC)};
	if (t->folder < 0)
		return false;
	if (open_unnamed(t, mode))
		return true;
	for (unsigned i = 0; i < TRIES && t->fd < 0; i++) {
		make_name(t, i);
		t->fd = openat(t->folder, t->name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
		if (t->fd < 0 && errno != EEXIST)
			break;
	}
	if (t->fd < 0)
		t->name[0] = '\0';
	return t->fd >= 0;
}

bool temporary_keep(const struct temporary *t, const struct stat *replaced)
{
	return fchown(t->fd, replaced->st_uid, replaced->st_gid) == 0 && fchmod(t->fd, replaced->st_mode & 0777) == 0;
}

// Is it a file that a process of this user has left here, which was killed in the moment before the rename? Another
// namespace's process is not to be seen: what is young may be its.
static bool is_stale(const struct temporary *t, const char *name)
{
	char path[32];
	struct stat about;
	long pid;
	int end = 0;
	if (sscanf(name, ".candil-%ld-%*u.tmp%n", &pid, &end) != 1 || end == 0 || name[end])
		return false;
	snprintf(path, sizeof path, "/proc/%ld", pid);
	return access(path, F_OK) != 0 && access("/proc/self", F_OK) == 0 &&
	       fstatat(t->folder, name, &about, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(about.st_mode) &&
	       about.st_uid == geteuid() && time(NULL) - about.st_mtime > TEMPORARY_STALE_SECONDS;
}

// A file system has no rename that takes a file without a name, so a kill may leave one. Whoever replaces a file in the same
// folder takes them away.
static void remove_stale(const struct temporary *t)
{
	const int fd = openat(t->folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	DIR *dir = fd < 0 ? NULL : fdopendir(fd);
	if (!dir && fd >= 0)
		close(fd);
	for (const struct dirent *e; dir && (e = readdir(dir));)
		if (is_stale(t, e->d_name))
			unlinkat(t->folder, e->d_name, 0);
	if (dir)
		closedir(dir);
}

// What a network file system cannot store it says as a descriptor is closed.
static bool flush(const struct temporary *t)
{
	const int copy = fcntl(t->fd, F_DUPFD_CLOEXEC, 0);
	return copy >= 0 && close(copy) == 0;
}

bool temporary_place(struct temporary *t, int into, const char *name)
{
	char path[32];
	if (!flush(t))
		return false;
	into = into < 0 ? t->folder : into;
	make_path(t, path);
	if (!t->name[0]) {
		// A link takes nobody's place. Where somebody is, another name is needed, for the moment until the rename.
		if (linkat(AT_FDCWD, path, into, name, AT_SYMLINK_FOLLOW) == 0)
			return true;
		for (unsigned i = 0; i < TRIES && errno == EEXIST; i++) {
			make_name(t, i);
			if (linkat(AT_FDCWD, path, t->folder, t->name, AT_SYMLINK_FOLLOW) == 0)
				break;
			t->name[0] = '\0';
		}
	}
	if (!t->name[0] || renameat(t->folder, t->name, into, name) != 0)
		return false;
	t->name[0] = '\0';
	remove_stale(t);
	return true;
}

void temporary_finish(struct temporary *t)
{
	const int failure = errno;
	if (t->name[0])
		unlinkat(t->folder, t->name, 0);
	if (t->fd >= 0)
		close(t->fd);
	if (t->folder >= 0)
		close(t->folder);
	*t = (struct temporary)TEMPORARY_NONE;
	errno = failure;
}
