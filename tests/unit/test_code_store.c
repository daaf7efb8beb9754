// Modules kept on disk: what was written is read, and a file that is anything else is as none.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <dirent.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/worker/code_store.h"

#define WORDS 1000u

static char path[] = "/tmp/candil-store-XXXXXX";
static int folder;
static uint32_t module[WORDS];

static int setup(void **state)
{
	(void)state;
	if (!mkdtemp(path))
		return -1;
	folder = open(path, O_PATH | O_DIRECTORY | O_CLOEXEC);
	module[0] = 0x07230203u;
	for (uint32_t i = 1; i < WORDS; i++)
		module[i] = i * 2654435761u;
	return folder < 0 ? -1 : 0;
}

// Calls for each file, and how many there are.
static unsigned each_file(void (*call)(const char *name))
{
	unsigned count = 0;
	DIR *list = opendir(path);
	assert_non_null(list);
	for (const struct dirent *entry; (entry = readdir(list));)
		if (entry->d_name[0] != '.') {
			count++;
			if (call)
				call(entry->d_name);
		}
	closedir(list);
	return count;
}

static void take_away(const char *name)
{
	assert_int_equal(unlinkat(folder, name, 0), 0);
}

static int teardown(void **state)
{
	(void)state;
	each_file(take_away);
	close(folder);
	return rmdir(path);
}

static bool has(uint64_t number)
{
	size_t bytes = 0;
	uint32_t *code = code_store_read(folder, number, &bytes);
	if (!code)
		return false;
	assert_int_equal(bytes, sizeof module);
	assert_memory_equal(code, module, sizeof module);
	free(code);
	return true;
}

static void what_was_written_is_read(void **state)
{
	size_t bytes;
	(void)state;
	assert_false(has(7));
	code_store_write(folder, 7, module, sizeof module);
	assert_true(has(7));
	assert_false(has(8));
	code_store_write(folder, 8, module, sizeof module);
	code_store_write(folder, 7, module, sizeof module); // in its own place
	assert_true(has(7) && has(8));
	assert_int_equal(each_file(NULL), 2);
	// Where there is no folder, nothing is kept.
	assert_null(code_store_read(-1, 7, &bytes));
	code_store_write(-1, 7, module, sizeof module);
	each_file(take_away);
}

static char the_name[256];

static void remember(const char *name)
{
	snprintf(the_name, sizeof the_name, "%s", name);
}

// Put `bytes` of `file` in the place of the one file.
static void put(const unsigned char *file, size_t bytes)
{
	const int fd = openat(folder, the_name, O_WRONLY | O_CREAT | O_TRUNC, 0600);
	assert_true(fd >= 0);
	assert_int_equal(write(fd, file, bytes), bytes);
	close(fd);
}

static void what_is_anything_else_is_as_none(void **state)
{
	unsigned char file[sizeof module + 200], other[sizeof file + 4] = {0};
	(void)state;
	code_store_write(folder, 7, module, sizeof module);
	assert_int_equal(each_file(remember), 1);
	int fd = openat(folder, the_name, O_RDONLY);
	const ssize_t n = read(fd, file, sizeof file);
	close(fd);
	assert_true(n > (ssize_t)sizeof module);
	const size_t bytes = (size_t)n;
	// Every bit, one after the other; every length; zeros as a disk leaves them.
	for (size_t i = 0; i < 8 * bytes; i += i < 8 * 100 ? 1 : 61) {
		memcpy(other, file, bytes);
		other[i / 8] ^= (unsigned char)(1u << i % 8);
		put(other, bytes);
		assert_false(has(7));
	}
	for (size_t length = 0; length < bytes; length += length < 100 ? 1 : 37) {
		put(file, length);
		assert_false(has(7));
	}
	memcpy(other, file, bytes);
	put(other, bytes + 4);
	assert_false(has(7));
	memset(other, 0, bytes);
	put(other, bytes);
	assert_false(has(7));
	// One of another number under this one's name.
	code_store_write(folder, 9, module, sizeof module);
	char nine[sizeof the_name];
	snprintf(nine, sizeof nine, "%.*s%016x", (int)(strlen(the_name) - 16), the_name, 9);
	assert_true(has(9));
	assert_int_equal(renameat(folder, nine, folder, the_name), 0);
	assert_false(has(7));
	// What is no file, or not there.
	take_away(the_name);
	assert_int_equal(mkfifoat(folder, the_name, 0600), 0);
	assert_false(has(7));
	take_away(the_name);
	assert_int_equal(symlinkat("elsewhere", folder, the_name), 0);
	assert_false(has(7));
	// Written anew it is there again.
	code_store_write(folder, 7, module, sizeof module);
	assert_true(has(7));
	put(file, bytes);
	assert_true(has(7));
	each_file(take_away);
}

static void what_is_too_large_is_not_kept(void **state)
{
	uint32_t *large = calloc(1, CODE_STORE_BYTES_MAX + 4);
	(void)state;
	assert_non_null(large);
	large[0] = module[0];
	code_store_write(folder, 7, large, CODE_STORE_BYTES_MAX + 4);
	assert_int_equal(each_file(NULL), 0);
	free(large);
}

// The file of a number is that long unused.
static void age(uint64_t number, time_t seconds)
{
	char name[sizeof the_name];
	struct timespec times[2] = {{.tv_nsec = UTIME_OMIT}, {.tv_sec = 1000000000 - seconds}};
	snprintf(name, sizeof name, "%.*s%016llx", (int)(strlen(the_name) - 16), the_name, (unsigned long long)number);
	assert_int_equal(utimensat(folder, name, times, 0), 0);
}

static void the_one_unused_for_longest_goes(void **state)
{
	(void)state;
	for (uint64_t i = 1; i <= CODE_STORE_MOST; i++) {
		code_store_write(folder, i, module, sizeof module);
		age(i, (time_t)(CODE_STORE_MOST - i));
	}
	assert_int_equal(each_file(NULL), CODE_STORE_MOST);
	assert_true(has(1)); // which is a use
	code_store_write(folder, 1000, module, sizeof module);
	assert_int_equal(each_file(NULL), CODE_STORE_MOST);
	assert_true(has(1) && has(3) && has(1000));
	assert_false(has(2));
	each_file(take_away);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(what_was_written_is_read),
	    cmocka_unit_test(what_is_anything_else_is_as_none),
	    cmocka_unit_test(what_is_too_large_is_not_kept),
	    cmocka_unit_test(the_one_unused_for_longest_goes),
	};
	return cmocka_run_group_tests(tests, setup, teardown);
}
