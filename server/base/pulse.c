#include "server/base/pulse.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "server/base/clock.h"

#define LEAST_SHARE 100u // less than a hundredth of a processor is no work: threads of drivers wake now and then

// Processor time of all threads that it has and had.
static uint64_t burnt_us(pid_t pid)
{
	clockid_t clock;
	struct timespec t;
	if (clock_getcpuclockid(pid, &clock) != 0 || clock_gettime(clock, &t) != 0)
		return 0;
	return (uint64_t)t.tv_sec * 1000000u + (uint64_t)t.tv_nsec / 1000u;
}

// The state of a thread, which follows its name in parentheses, and the name may have some itself. 0: unknown.
static char state_of(int tasks, const char *thread)
{
	char path[64], text[512];
	const int length = snprintf(path, sizeof path, "%s/stat", thread);
	const int fd = length > 0 && (size_t)length < sizeof path ? openat(tasks, path, O_RDONLY | O_CLOEXEC) : -1;
	if (fd < 0)
		return 0;
	const ssize_t got = read(fd, text, sizeof text - 1);
	close(fd);
	text[got > 0 ? got : 0] = 0;
	const char *end = strrchr(text, ')');
	return end && end[1] == ' ' ? end[2] : 0;
}

// Has someone stopped it? Of children alone it can be told.
static bool is_stopped(pid_t pid)
{
	siginfo_t info = {0};
	return waitid(P_PID, (id_t)pid, &info, WSTOPPED | WNOHANG | WNOWAIT) == 0 && info.si_pid == pid;
}

// Does any thread run or wait for a processor (R), or for a disk (D), or is held by a debugger (t)?
static bool could_work(pid_t pid)
{
	char path[32];
	bool found = false;
	snprintf(path, sizeof path, "/proc/%d/task", (int)pid);
	DIR *tasks = opendir(path);
	// A loader's threads are seen by root alone where /proc is mounted with hidepid=2, because the loader may not be
	// traced. What is not known is not held against it: its processor time is, and the bounds of that and of the clock.
	if (!tasks && errno != ENOENT && errno != EACCES && errno != EPERM)
		return false;
	if (!tasks)
		return access("/proc/self/task", F_OK) == 0 && kill(pid, 0) == 0 && !is_stopped(pid);
	for (const struct dirent *entry = readdir(tasks); entry && !found; entry = readdir(tasks)) {
		const char state = entry->d_name[0] == '.' ? 0 : state_of(dirfd(tasks), entry->d_name);
		found = state == 'R' || state == 'D' || state == 't';
	}
	closedir(tasks);
	return found;
}

void pulse_begin(struct pulse *pulse, pid_t pid)
{
	*pulse = (struct pulse){.pid = pid, .burnt_us = burnt_us(pid), .looked_us = clock_us()};
}

uint64_t pulse_look(struct pulse *pulse)
{
	const uint64_t now = clock_us(), burnt = burnt_us(pulse->pid);
	const uint64_t passed = now - pulse->looked_us;
	const uint64_t worked = burnt > pulse->burnt_us ? burnt - pulse->burnt_us : 0;
	pulse->looked_us = now;
	pulse->burnt_us = burnt;
	if (worked * LEAST_SHARE > passed || could_work(pulse->pid))
		pulse->still = 0;
	else
		pulse->still++;
	return worked < passed ? worked : passed;
}
