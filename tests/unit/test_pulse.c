// Who is at work and who hangs, by what processes do: each test looks until it has seen enough, not until a time is over.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/pulse.h"

#define LOOK_US 20000

static void sleep_for_ever(void)
{
	for (;;)
		pause();
}

static void burn_for_ever(void)
{
	for (volatile unsigned i = 0;; i++)
		;
}

static void *burn_in_a_thread(void *unused)
{
	(void)unused;
	burn_for_ever();
	return NULL;
}

static void burn_twice(void)
{
	pthread_t thread;
	pthread_create(&thread, NULL, burn_in_a_thread, NULL);
	burn_for_ever();
}

static int sleep_in_a_stack(void *stack)
{
	(void)stack;
	sleep_for_ever();
	return 0;
}

// Waits for its child in a way that no signal interrupts, as others wait for a disk.
static void wait_uninterrupted(void)
{
	static char stack[16384];
	clone(sleep_in_a_stack, stack + sizeof stack, CLONE_VFORK | CLONE_VM | SIGCHLD, NULL);
	_exit(1);
}

// In a group of its own, with what it may start itself.
static pid_t begin(void (*what)(void))
{
	const pid_t pid = fork();
	assert_true(pid >= 0);
	if (pid == 0) {
		setpgid(0, 0);
		what();
	}
	setpgid(pid, pid);
	return pid;
}

static void end(pid_t pid)
{
	kill(-pid, SIGKILL);
	while (waitpid(-pid, NULL, 0) > 0)
		;
}

// Look until it has been still for so many looks; false: it worked at the 200th look.
static bool gets_still(pid_t pid)
{
	struct pulse pulse;
	pulse_begin(&pulse, pid);
	for (unsigned i = 0; i < 200 && pulse.still < PULSE_LOOKS; i++) {
		usleep(LOOK_US);
		pulse_look(&pulse);
	}
	return pulse.still >= PULSE_LOOKS;
}

// Is it at work at so many looks in a row, once it is?
static bool goes_on(pid_t pid, uint64_t *work_us)
{
	struct pulse pulse;
	unsigned alive = 0;
	pulse_begin(&pulse, pid);
	for (unsigned i = 0; i < 200 && alive < 2 * PULSE_LOOKS; i++) {
		usleep(LOOK_US);
		*work_us += pulse_look(&pulse);
		alive = pulse.still == 0 ? alive + 1 : 0;
	}
	return alive == 2 * PULSE_LOOKS;
}

static void who_sleeps_hangs(void **state)
{
	(void)state;
	const pid_t pid = begin(sleep_for_ever);
	assert_true(gets_still(pid));
	end(pid);
}

static void who_is_stopped_hangs(void **state)
{
	(void)state;
	const pid_t pid = begin(burn_for_ever);
	kill(pid, SIGSTOP);
	assert_true(gets_still(pid));
	end(pid);
}

static void who_has_ended_hangs(void **state)
{
	(void)state;
	const pid_t pid = begin(burn_for_ever);
	end(pid);
	assert_true(gets_still(pid));
}

static void who_burns_works(void **state)
{
	(void)state;
	uint64_t work_us = 0;
	const uint64_t start = clock_us();
	const pid_t pid = begin(burn_for_ever);
	assert_true(goes_on(pid, &work_us));
	assert_in_range(work_us, 1, clock_us() - start);
	end(pid);
}

static void two_threads_count_as_one(void **state)
{
	(void)state;
	uint64_t work_us = 0;
	const uint64_t start = clock_us();
	const pid_t pid = begin(burn_twice);
	assert_true(goes_on(pid, &work_us));
	assert_in_range(work_us, 1, clock_us() - start);
	end(pid);
}

// It and one that the kernel always prefers have one processor between them.
static void who_waits_for_a_processor_works(void **state)
{
	(void)state;
	uint64_t work_us = 0;
	cpu_set_t here, before;
	CPU_ZERO(&here);
	assert_int_equal(sched_getaffinity(0, sizeof before, &before), 0);
	for (size_t i = 0; i < CPU_SETSIZE && CPU_COUNT(&here) == 0; i++)
		if (CPU_ISSET(i, &before))
			CPU_SET(i, &here);
	const pid_t poor = begin(burn_for_ever), rich = begin(burn_for_ever);
	const struct sched_param none = {0};
	assert_int_equal(sched_setaffinity(poor, sizeof here, &here), 0);
	assert_int_equal(sched_setaffinity(rich, sizeof here, &here), 0);
	assert_int_equal(sched_setscheduler(poor, SCHED_IDLE, &none), 0);
	assert_true(goes_on(poor, &work_us));
	end(poor);
	end(rich);
}

static void who_waits_for_a_disk_works(void **state)
{
	(void)state;
	uint64_t work_us = 0;
	const pid_t pid = begin(wait_uninterrupted);
	assert_true(goes_on(pid, &work_us));
	end(pid);
}

// ---- where /proc hides what may not be traced
// ------------------------------------------------------------------------------

enum { UNTRIED = 77, NOBODY = 65534 };

static void sleep_untraced(void)
{
	prctl(PR_SET_DUMPABLE, 0, 0, 0, 0);
	sleep_for_ever();
}

static void sleep_traceable(void)
{
	prctl(PR_SET_DUMPABLE, 1, 0, 0, 0);
	sleep_for_ever();
}

static void stop_untraced(void)
{
	prctl(PR_SET_DUMPABLE, 0, 0, 0, 0);
	raise(SIGSTOP);
}

static bool gets_still_and_ends(void (*what)(void))
{
	const pid_t pid = begin(what);
	const bool still = gets_still(pid);
	end(pid);
	return still;
}

// As a user whose /proc is so, in a process of its own.
static int look_as_nobody(void)
{
	if (unshare(CLONE_NEWNS) != 0 || mount(NULL, "/", NULL, MS_REC | MS_PRIVATE, NULL) != 0 ||
	    mount("proc", "/proc", "proc", 0, "hidepid=2") != 0 || setgid(NOBODY) != 0 || setuid(NOBODY) != 0)
		return UNTRIED;
	if (!gets_still_and_ends(sleep_traceable))
		return 1;
	if (gets_still_and_ends(sleep_untraced))
		return 2;
	return gets_still_and_ends(stop_untraced) ? 0 : 3;
}

static void who_cannot_be_seen_is_not_said_to_hang(void **state)
{
	int status;
	(void)state;
	fflush(NULL);
	const pid_t pid = fork();
	assert_true(pid >= 0);
	if (pid == 0)
		_exit(look_as_nobody());
	assert_int_equal(waitpid(pid, &status, 0), pid);
	if (WIFEXITED(status) && WEXITSTATUS(status) == UNTRIED)
		skip();
	assert_int_equal(status, 0);
}

// What the watcher lacks is no sign of work.
static void who_sleeps_hangs_without_descriptors(void **state)
{
	struct rlimit before;
	(void)state;
	assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
	const struct rlimit none = {.rlim_cur = 0, .rlim_max = before.rlim_max};
	const pid_t pid = begin(sleep_for_ever);
	assert_int_equal(setrlimit(RLIMIT_NOFILE, &none), 0);
	const bool still = gets_still(pid);
	assert_int_equal(setrlimit(RLIMIT_NOFILE, &before), 0);
	end(pid);
	assert_true(still);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(who_sleeps_hangs),
	    cmocka_unit_test(who_is_stopped_hangs),
	    cmocka_unit_test(who_has_ended_hangs),
	    cmocka_unit_test(who_burns_works),
	    cmocka_unit_test(two_threads_count_as_one),
	    cmocka_unit_test(who_waits_for_a_processor_works),
	    cmocka_unit_test(who_waits_for_a_disk_works),
	    cmocka_unit_test(who_cannot_be_seen_is_not_said_to_hang),
	    cmocka_unit_test(who_sleeps_hangs_without_descriptors),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
