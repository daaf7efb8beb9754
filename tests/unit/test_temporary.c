// Files on their way to their names, on a file system that has files without names, and on one that has not. So is the file
// that asks whether there is room for compiled shaders.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "server/base/replace.h"
#include "server/base/temporary.h"
#include "server/worker/cache.h"

static bool refuses; // the file system knows no files without names
static char folder[] = "/tmp/candil-test-XXXXXX";

int __real_openat(int at, const char *path, int flags, ...);
int __wrap_openat(int at, const char *path, int flags, ...);

int __wrap_openat(int at, const char *path, int flags, ...)
{
	va_list args;
	va_start(args, flags);
	const bool has_mode = (flags & O_TMPFILE) == O_TMPFILE || flags & O_CREAT;
	const mode_t mode = has_mode ? va_arg(args, mode_t) : 0;
	va_end(args);
	if (refuses && (flags & O_TMPFILE) == O_TMPFILE) {
		errno = EOPNOTSUPP;
		return -1;
	}
	return __real_openat(at, path, flags, mode);
}

// How many files the folder has.
static unsigned count(void)
{
	unsigned found = 0;
	DIR *d = opendir(folder);
	assert_non_null(d);
	for (const struct dirent *e; (e = readdir(d));)
		found += e->d_name[0] != '.' || strlen(e->d_name) > 2;
	closedir(d);
	return found;
}

static void assert_holds(const char *name, const char *wanted)
{
	char path[64], text[64] = "";
	snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *file = fopen(path, "re");
	assert_non_null(file);
	const size_t bytes = fread(text, 1, sizeof text - 1, file);
	fclose(file);
	assert_int_equal(bytes, strlen(wanted));
	assert_string_equal(text, wanted);
}

static void clear(const char *name)
{
	char path[64];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	assert_int_equal(unlink(path), 0);
}

static void write_one(const char *name, const char *text)
{
	struct temporary t;
	assert_true(temporary_open(&t, AT_FDCWD, folder, 0666));
	assert_int_equal(write(t.fd, text, strlen(text)), (ssize_t)strlen(text));
	assert_true(temporary_place(&t, -1, name));
	temporary_finish(&t);
}

static void test_it_takes_the_place_of_what_is_there(void **state)
{
	(void)state;
	write_one("name", "first");
	assert_holds("name", "first");
	write_one("name", "second");
	assert_holds("name", "second");
	assert_int_equal(count(), 1);
	clear("name");
}

static void test_what_is_not_placed_goes(void **state)
{
	(void)state;
	struct temporary t;
	assert_true(temporary_open(&t, AT_FDCWD, folder, 0666));
	assert_int_equal(write(t.fd, "text", 4), 4);
	assert_int_equal(count(), refuses ? 1 : 0);
	errno = ENOSPC;
	temporary_finish(&t);
	assert_int_equal(errno, ENOSPC);
	assert_int_equal(count(), 0);
	temporary_finish(&t);
	assert_false(temporary_open(&t, AT_FDCWD, "/nonexistent", 0666));
	assert_int_equal(errno, ENOENT);
	temporary_finish(&t);
}

static void test_a_planted_link_is_not_followed(void **state)
{
	(void)state;
	char planted[64], name[64];
	snprintf(planted, sizeof planted, "%s/.candil-%ld-0.tmp", folder, (long)getpid());
	snprintf(name, sizeof name, "%s/name", folder);
	assert_int_equal(symlink("victim", planted), 0);
	assert_int_equal(symlink("victim", name), 0);
	write_one("name", "text");
	struct stat about;
	assert_int_equal(lstat(name, &about), 0);
	assert_true(S_ISREG(about.st_mode));
	assert_holds("name", "text");
	assert_int_equal(count(), 2); // and no victim
	clear("name");
	assert_int_equal(unlink(planted), 0);
}

static int reserving; // errno of a file system that cannot reserve room
static unsigned seen; // files in the folder at that moment

int __wrap_fallocate(int fd, int mode, off_t offset, off_t bytes);

int __wrap_fallocate(int fd, int mode, off_t offset, off_t bytes)
{
	(void)mode;
	(void)offset;
	seen = count();
	errno = reserving;
	return fd >= 0 && bytes > 0 && !reserving ? 0 : -1;
}

static void test_a_cache_is_full_only_where_it_is(void **state)
{
	static const struct {
		int failure;
		bool room;
	} cases[] = {{0, true},          {ENOSPC, false}, {EDQUOT, false}, {EFBIG, false},
		     {EOPNOTSUPP, true}, {EINTR, true},   {EIO, true},     {EINVAL, true}};
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		reserving = cases[i].failure;
		seen = 1;
		assert_int_equal(cache_has_room(folder), cases[i].room);
		assert_int_equal(seen, 0); // what a kill now would leave
		assert_int_equal(count(), 0);
	}
	assert_true(cache_has_room("/nonexistent")); // nobody knows
}

static void test_replaced_files_keep_their_mode(void **state)
{
	(void)state;
	char name[64];
	struct error err;
	struct stat before, after;
	snprintf(name, sizeof name, "%s/name", folder);
	umask(022);
	assert_int_equal(replace_file(name, 0666, "first", 5, &err), STATUS_OK);
	assert_int_equal(stat(name, &before), 0);
	assert_int_equal(before.st_mode & 0777, 0644);
	assert_int_equal(chmod(name, 04751), 0);
	assert_int_equal(replace_file(name, 0666, "second", 6, &err), STATUS_OK);
	assert_int_equal(stat(name, &after), 0);
	assert_int_equal(after.st_mode & 07777, 0751);
	assert_true(after.st_ino != before.st_ino);
	assert_holds("name", "second");
	// A folder of that name stays, and nothing else does.
	clear("name");
	assert_int_equal(mkdir(name, 0777), 0);
	assert_int_equal(replace_file(name, 0666, "third", 5, &err), STATUS_IO);
	assert_int_equal(count(), 1);
	assert_int_equal(rmdir(name), 0);
}

static int has_names(void **state)
{
	(void)state;
	refuses = true;
	return 0;
}

static void leave(const char *name, time_t ago)
{
	char path[128];
	const struct timespec at[2] = {{.tv_sec = time(NULL) - ago}, {.tv_sec = time(NULL) - ago}};
	snprintf(path, sizeof path, "%s/%s", folder, name);
	const int fd = open(path, O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
	assert_true(fd >= 0 && futimens(fd, at) == 0);
	close(fd);
}

static bool is_there(const char *name)
{
	char path[128];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	return access(path, F_OK) == 0;
}

static void test_what_a_kill_has_left_goes(void **state)
{
	char path[64];
	struct error err;
	struct temporary used;
	const time_t old = TEMPORARY_STALE_SECONDS + 10;
	(void)state;
	// No process that is to be seen has the number: it is above the kernel's largest.
	const char *const stays[] = {".candil-99999999-1.tmp", ".candil-99999999-0.tmp.png", "candil-99999999-0.tmp",
				     ".candil--5-0.tmp",       ".candil-+5-0.tmp",           ".candil- 5-0.tmp"};
	const unsigned count_stays = sizeof stays / sizeof *stays;
	for (unsigned i = 0; i < count_stays; i++)
		leave(stays[i], i == 0 ? 0 : old);
	leave(".candil-99999999-0.tmp", old);
	// One that somebody writes for very long, whose process is not to be seen.
	const struct timespec at[2] = {{.tv_sec = time(NULL) - old}, {.tv_sec = time(NULL) - old}};
	assert_true(temporary_open(&used, AT_FDCWD, folder, 0600) && futimens(used.fd, at) == 0);
	if (used.name[0]) {
		assert_int_equal(renameat(used.folder, used.name, used.folder, ".candil-99999999-2.tmp"), 0);
		snprintf(used.name, sizeof used.name, ".candil-99999999-2.tmp");
	}
	snprintf(path, sizeof path, "%s/stale", folder);
	assert_int_equal(replace_file(path, 0600, "a", 1, &err), STATUS_OK);
	assert_int_equal(replace_file(path, 0600, "b", 1, &err), STATUS_OK);
	assert_false(is_there(".candil-99999999-0.tmp"));
	assert_true(!used.name[0] || is_there(used.name));
	temporary_finish(&used);
	for (unsigned i = 0; i < count_stays; i++) {
		assert_true(is_there(stays[i]));
		clear(stays[i]);
	}
	// A process looks once, not for each picture of a sweep.
	leave(".candil-99999999-0.tmp", old);
	assert_int_equal(replace_file(path, 0600, "c", 1, &err), STATUS_OK);
	assert_true(is_there(".candil-99999999-0.tmp"));
	clear(".candil-99999999-0.tmp");
	clear("stale");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_what_a_kill_has_left_goes), // first: a process looks once
	    cmocka_unit_test(test_it_takes_the_place_of_what_is_there),
	    cmocka_unit_test(test_what_is_not_placed_goes),
	    cmocka_unit_test(test_a_planted_link_is_not_followed),
	    cmocka_unit_test(test_a_cache_is_full_only_where_it_is),
	    cmocka_unit_test(test_replaced_files_keep_their_mode),
	};
	if (!mkdtemp(folder))
		return EXIT_FAILURE;
	const int at = open(folder, O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);
	refuses = at < 0; // then both rounds are the second
	if (at >= 0)
		close(at);
	int failed;
	const pid_t pid = fork(); // for what a process does once
	if (pid == 0)
		_exit(cmocka_run_group_tests_name("without a name", tests, NULL, NULL));
	if (pid < 0 || waitpid(pid, &failed, 0) != pid)
		return EXIT_FAILURE;
	failed = failed != 0 || cmocka_run_group_tests_name("with a name", tests, has_names, NULL) != 0;
	rmdir(folder);
	return failed;
}
