#include "server/loader/sandbox.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "protocol/limits.h"
#include "server/base/landlock.h"
#include "server/loader/sandbox_seccomp.h"

enum { THREAD_WAIT_NS = 200000, THREAD_WAITS = 10000 }; // at most 2 s in all

#ifdef __SANITIZE_ADDRESS__
enum { SANITIZED = 1 }; // its shadow memory takes terabytes of address space, and its leak check traces this process
#else
enum { SANITIZED = 0 };
#endif

// Lower a limit; one that is already lower is kept.
static bool lower(int which, rlim_t soft, rlim_t hard)
{
	struct rlimit now;
	if (getrlimit((__rlimit_resource_t)which, &now) != 0)
		return false;
	now.rlim_max = hard < now.rlim_max ? hard : now.rlim_max;
	now.rlim_cur = soft < now.rlim_cur ? soft : now.rlim_cur;
	now.rlim_cur = now.rlim_cur < now.rlim_max ? now.rlim_cur : now.rlim_max;
	return setrlimit((__rlimit_resource_t)which, &now) == 0;
}

// RLIMIT_FSIZE also applies to memory files, so it is the blob's limit. RLIMIT_NPROC is not used, because it counts all
// processes of the user.
static void enter_limits(struct fence_state *s)
{
	const bool memory = SANITIZED || lower(RLIMIT_AS, LIMIT_LOADER_BYTES, LIMIT_LOADER_BYTES);
	const bool time = lower(RLIMIT_CPU, LIMIT_LOAD_SECONDS, LIMIT_LOAD_SECONDS + 5);
	const bool files = lower(RLIMIT_NOFILE, LIMIT_LOADER_FILES, LIMIT_LOADER_FILES);
	const bool size = lower(RLIMIT_FSIZE, LIMIT_BLOB_BYTES, LIMIT_BLOB_BYTES);
	const bool core = lower(RLIMIT_CORE, 0, 0);
	signal(SIGXFSZ, SIG_IGN); // beyond the size, a call fails and is reported
	if (memory && time && files && size && core)
		fence_state_set(s, true, "%llu MiB%s, %u s of processor time, %u descriptors, no core file",
				LIMIT_LOADER_BYTES >> 20, SANITIZED ? " (not under AddressSanitizer)" : "",
				LIMIT_LOAD_SECONDS, LIMIT_LOADER_FILES);
	else
		fence_state_set(s, false, "not set:%s%s%s%s%s", memory ? "" : " memory", time ? "" : " time",
				files ? "" : " descriptors", size ? "" : " file size", core ? "" : " core");
}

static void enter_privileges(struct fence_state *s)
{
	fence_privileges(s);
	if (!s->holds)
		return;
	if (!SANITIZED && prctl(PR_SET_DUMPABLE, 0, 0, 0, 0) != 0)
		fence_state_set(s, false, "dumpable: %s", strerror(errno));
	else
		fence_state_set(s, true, "no new ones, no capabilities, %s",
				SANITIZED ? "traceable under AddressSanitizer" : "not traceable");
}

// Landlock confines the calling thread and those that it creates later, not other threads. OpenImageIO loads OpenVDB, and
// that a logger whose constructor starts four threads before main. They are told to end, which takes them a moment. The
// function is looked up by name, because nothing here links that library.
static int threads_left(void)
{
	void (*end_logger)(void) = NULL;
	*(void **)&end_logger = dlsym(RTLD_DEFAULT, "_ZN9log4cplus18shutdownThreadPoolEv");
	int threads = fence_threads();
	if (threads <= 1 || !end_logger)
		return threads;
	end_logger();
	for (int i = 0; i < THREAD_WAITS && threads > 1; i++) {
		nanosleep(&(struct timespec){.tv_nsec = THREAD_WAIT_NS}, NULL);
		threads = fence_threads();
	}
	return threads;
}

static void enter_landlock(int folder, int threads, struct fence_state *s)
{
	struct landlock l;
	landlock_begin(&l, SCOPE_ALL);
	if (folder >= 0)
		landlock_allow_fd(&l, folder, USE_READ);
	if (SANITIZED)
		landlock_allow(&l, "/proc", USE_READ); // the leak check reads the process's own maps and threads
	const int abi = l.abi;
	fence_state_landlock(s, landlock_enter(&l), abi, threads);
}

static void enter_seccomp(bool landlock, struct fence_state *s)
{
	const int failed = seccomp_enter();
	if (failed)
		fence_state_set(s, false, "the kernel does not take the filter: %s", strerror(failed));
	else // a filter cannot read what openat2's pointer points to
		fence_state_set(s, true, landlock ? "an allow-list" : "an allow-list; without landlock openat2 can write");
}

// If memory runs out because of a scene, the kernel should end this process, not the front.
static void offer_to_oom_killer(void)
{
	// May fail: there may be no /proc, and root's daemon forbids it (server/front/fence.c).
	int fd = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
	if (fd < 0)
		return;
	ssize_t ignored = write(fd, "1000", 4);
	(void)ignored;
	close(fd);
}

void sandbox_enter(int folder, struct fence_report *report)
{
	report->threads = threads_left();
	offer_to_oom_killer();
	enter_limits(&report->layers[FENCE_LIMITS]);
	enter_privileges(&report->layers[FENCE_PRIVILEGES]);
	enter_landlock(folder, report->threads, &report->layers[FENCE_LANDLOCK]);
	enter_seccomp(report->layers[FENCE_LANDLOCK].holds, &report->layers[FENCE_SECCOMP]);
}
