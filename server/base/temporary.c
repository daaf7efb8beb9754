#include "server/base/temporary.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdio.h>
#include <sys/file.h>
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
	const bool unnamed = open_unnamed(t, mode);
	for (unsigned i = 0; !unnamed && i < TRIES && t->fd < 0; i++) {
		make_name(t, i);
		t->fd = openat(t->folder, t->name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
		if (t->fd < 0 && errno != EEXIST)
			break;
	}
	if (t->fd < 0) {
		t->name[0] = '\0';
		return false;
	}
	(void)flock(t->fd, LOCK_EX | LOCK_NB); // where there are no locks, nobody can get one and remove it
	return true;
}

bool temporary_keep(const struct temporary *t, const struct stat *replaced)
{
	return fchown(t->fd, replaced->st_uid, replaced->st_gid) == 0 && fchmod(t->fd, replaced->st_mode & 0777) == 0;
}

// Remove what has a temporary's name, if it is a file of this user's that is old and nobody's any more. Whose it is holds a
// lock on it, on this machine or another.
static void remove_if_stale(const struct temporary *t, const char *name)
{
	struct stat about, named;
	int end = 0;
	if (sscanf(name, ".candil-%*[0-9]-%*[0-9].tmp%n", &end) != 0 || end == 0 || name[end])
		return;
	const int fd = openat(t->folder, name, O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
	// Who had the lock before may have moved or removed it, and the name may be another's by now.
	if (fd >= 0 && flock(fd, LOCK_EX | LOCK_NB) == 0 && fstat(fd, &about) == 0 && S_ISREG(about.st_mode) &&
	    about.st_uid == geteuid() && time(NULL) - about.st_mtime > TEMPORARY_STALE_SECONDS &&
	    fstatat(t->folder, name, &named, AT_SYMLINK_NOFOLLOW) == 0 && named.st_ino == about.st_ino &&
	    named.st_dev == about.st_dev)
		unlinkat(t->folder, name, 0);
	if (fd >= 0)
		close(fd);
}

// A file system has no rename that takes a file without a name, so a kill may leave one. Each process takes them away where
// it first replaces a file. To list a large folder for every picture of a sweep would be slow.
static void remove_stale(const struct temporary *t)
{
	static atomic_flag looked = ATOMIC_FLAG_INIT;
	if (atomic_flag_test_and_set(&looked))
		return;
	const int fd = openat(t->folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	DIR *dir = fd < 0 ? NULL : fdopendir(fd);
	if (!dir && fd >= 0)
		close(fd);
	for (const struct dirent *e; dir && (e = readdir(dir));)
		remove_if_stale(t, e->d_name);
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
