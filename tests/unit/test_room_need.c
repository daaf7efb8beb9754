// What is said of a limit of address space: what a software device needs grows with the processors that this process may
// use, a GPU is not refused for it, and the limit is named once, where it may be the reason.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <sched.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "server/base/room_need.h"
#include "server/worker/vk/device.h"

static struct error err;

static unsigned count_advice(void)
{
	unsigned count = 0;
	for (const char *at = err.text; (at = strstr(at, "ulimit -v")); at++)
		count++;
	return count;
}

// What is said where so much is left.
static enum status with(uint64_t bytes)
{
	struct rlimit before, limit;
	unsigned long long pages = 0;
	FILE *file = fopen("/proc/self/statm", "re");
	assert_non_null(file);
	assert_int_equal(fscanf(file, "%llu", &pages), 1);
	fclose(file);
	assert_int_equal(getrlimit(RLIMIT_AS, &before), 0);
	limit = before;
	limit.rlim_cur = pages * (uint64_t)sysconf(_SC_PAGESIZE) + bytes;
	assert_int_equal(setrlimit(RLIMIT_AS, &limit), 0);
	const enum status status = room_need_device(&err);
	assert_int_equal(setrlimit(RLIMIT_AS, &before), 0);
	return status;
}

static void test_processors_of_others_take_nothing(void **state)
{
	cpu_set_t all, one;
	unsigned first = 0;
	const uint64_t half = ROOM_DEVICE_THREAD_BYTES / 2;
	(void)state;
	assert_int_equal(sched_getaffinity(0, sizeof all, &all), 0);
	const unsigned threads =
	    (unsigned)CPU_COUNT(&all) < ROOM_DEVICE_THREADS ? (unsigned)CPU_COUNT(&all) : ROOM_DEVICE_THREADS;
	assert_int_equal(with(ROOM_DEVICE_BYTES + threads * ROOM_DEVICE_THREAD_BYTES + half), STATUS_OK);
	assert_int_equal(with(ROOM_DEVICE_BYTES + threads * ROOM_DEVICE_THREAD_BYTES - half), STATUS_MEMORY);
	assert_int_equal(count_advice(), 1);
	while (!CPU_ISSET(first, &all))
		first++;
	CPU_ZERO(&one);
	CPU_SET(first, &one);
	assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
	assert_int_equal(with(ROOM_DEVICE_BYTES + ROOM_DEVICE_THREAD_BYTES + half), STATUS_OK);
	assert_int_equal(with(ROOM_DEVICE_BYTES + half), STATUS_MEMORY);
	assert_int_equal(sched_setaffinity(0, sizeof all, &all), 0);
}

static void test_room_for_one_device_is_no_matter_of_another(void **state)
{
	struct device_info infos[] = {{.type = "cpu", .software = true, .usable = true},
				      {.type = "discrete", .usable = true}};
	struct device_options options = {0};
	uint32_t chosen = 0, others;
	char why[LIMIT_TEXT + 1];
	(void)state;
	infos[0].room.code = STATUS_MEMORY;
	assert_int_equal(device_choose(infos, 2, &options, &chosen, &others, why, &err), STATUS_OK);
	assert_int_equal(chosen, 1);
	options.wanted = "cpu";
	assert_int_equal(device_choose(infos, 2, &options, &chosen, &others, why, &err), STATUS_MEMORY);
}

static void test_a_devices_own_memory_has_no_such_limit(void **state)
{
	struct rlimit before, limit;
	(void)state;
	assert_int_equal(getrlimit(RLIMIT_AS, &before), 0);
	limit = before;
	limit.rlim_cur = limit.rlim_cur == RLIM_INFINITY ? 1ull << 46 : limit.rlim_cur;
	assert_int_equal(setrlimit(RLIMIT_AS, &limit), 0);
	assert_int_equal(device_error(VK_ERROR_OUT_OF_DEVICE_MEMORY, "this", &err), STATUS_MEMORY);
	assert_int_equal(count_advice(), 0);
	assert_int_equal(device_error(VK_ERROR_OUT_OF_HOST_MEMORY, "this", &err), STATUS_MEMORY);
	assert_int_equal(count_advice(), 1);
	assert_int_equal(setrlimit(RLIMIT_AS, &before), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_processors_of_others_take_nothing),
	    cmocka_unit_test(test_room_for_one_device_is_no_matter_of_another),
	    cmocka_unit_test(test_a_devices_own_memory_has_no_such_limit),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
