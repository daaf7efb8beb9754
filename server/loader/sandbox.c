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
#include <sys/socket.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "protocol/limits.h"
#include "server/loader/sandbox_landlock.h"
#include "server/loader/sandbox_seccomp.h"

enum { THREAD_WAIT_NS = 200000, THREAD_WAITS = 10000 }; // at most 2 s in all

#ifdef __SANITIZE_ADDRESS__
enum { SANITIZED = 1 }; // its shadow memory takes terabytes of address space, and its leak check traces this process
#else
enum { SANITIZED = 0 };
#endif

const char *sandbox_layer_name(enum sandbox_layer layer)
{
	static const char *const names[SANDBOX_LAYERS] = {
	    [SANDBOX_LIMITS] = "limits",
	    [SANDBOX_PRIVILEGES] = "privileges",
	    [SANDBOX_LANDLOCK] = "landlock",
	    [SANDBOX_SECCOMP] = "seccomp",
	};
	return names[layer];
}

static void state(struct sandbox_state *s, bool holds, const char *format, ...) __attribute__((format(printf, 3, 4)));
static void state(struct sandbox_state *s, bool holds, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	s->holds = holds;
	vsnprintf(s->detail, sizeof s->detail, format, arguments);
	va_end(arguments);
}

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
static void enter_limits(struct sandbox_state *s)
{
	const bool memory = SANITIZED || lower(RLIMIT_AS, LIMIT_LOADER_BYTES, LIMIT_LOADER_BYTES);
	const bool time = lower(RLIMIT_CPU, LIMIT_LOAD_SECONDS, LIMIT_LOAD_SECONDS + 5);
	const bool files = lower(RLIMIT_NOFILE, LIMIT_LOADER_FILES, LIMIT_LOADER_FILES);
	const bool size = lower(RLIMIT_FSIZE, LIMIT_BLOB_BYTES, LIMIT_BLOB_BYTES);
	const bool core = lower(RLIMIT_CORE, 0, 0);
	signal(SIGXFSZ, SIG_IGN); // beyond the size, a call fails and is reported
	if (memory && time && files && size && core)
		state(s, true, "%llu MiB%s, %u s of processor time, %u descriptors, no core file", LIMIT_LOADER_BYTES >> 20,
		      SANITIZED ? " (not under AddressSanitizer)" : "", LIMIT_LOAD_SECONDS, LIMIT_LOADER_FILES);
	else
		state(s, false, "not set:%s%s%s%s%s", memory ? "" : " memory", time ? "" : " time",
		      files ? "" : " descriptors", size ? "" : " file size", core ? "" : " core");
}

static void enter_privileges(struct sandbox_state *s)
{
	if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0)
		state(s, false, "no_new_privs: %s", strerror(errno));
	else if (!SANITIZED && prctl(PR_SET_DUMPABLE, 0, 0, 0, 0) != 0)
		state(s, false, "dumpable: %s", strerror(errno));
	else
		state(s, true, SANITIZED ? "no new ones; traceable under AddressSanitizer" : "no new ones, not traceable");
}

static int count_threads(void)
{
	struct stat tasks;
	return stat("/proc/self/task", &tasks) == 0 ? (int)tasks.st_nlink - 2 : -1;
}

// Landlock confines the calling thread and those that it creates later, not other threads. OpenImageIO loads OpenVDB, and
// that a logger whose constructor starts four threads before main. They are told to end, which takes them a moment. The
// function is looked up by name, because nothing here links that library.
static int threads_left(void)
{
	void (*end_logger)(void) = NULL;
	*(void **)&end_logger = dlsym(RTLD_DEFAULT, "_ZN9log4cplus18shutdownThreadPoolEv");
	int threads = count_threads();
	if (threads <= 1 || !end_logger)
		return threads;
	end_logger();
	for (int i = 0; i < THREAD_WAITS && threads > 1; i++) {
		nanosleep(&(struct timespec){.tv_nsec = THREAD_WAIT_NS}, NULL);
		threads = count_threads();
	}
	return threads;
}

static void enter_landlock(int folder, int threads, struct sandbox_state *s)
{
	int abi;
	const int failed = landlock_enter(folder, &abi);
	if (failed == 0 && threads > 1)
		state(s, false, "it confines one thread of %d that libraries have started", threads);
	else if (failed == ENOSYS)
		state(s, false, "the kernel has no landlock, or something filters it away");
	else if (failed == EOPNOTSUPP)
		state(s, false, "the kernel has landlock, but it was not enabled at boot (lsm=landlock,...)");
	else if (failed)
		state(s, false, "landlock: %s", strerror(failed));
	else
		state(s, true, "ABI %d", abi);
}

static void enter_seccomp(bool landlock, struct sandbox_state *s)
{
	const int failed = seccomp_enter();
	if (failed)
		state(s, false, "the kernel does not take the filter: %s", strerror(failed));
	else // a filter cannot read what openat2's pointer points to
		state(s, true, landlock ? "an allow-list" : "an allow-list; without landlock openat2 can write");
}

// If memory runs out because of a scene, the kernel should end this process, not the front.
static void offer_to_oom_killer(void)
{
	int fd = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
	if (fd < 0)
		return;
	ssize_t ignored = write(fd, "1000", 4); // may fail: there may be no /proc
	(void)ignored;
	close(fd);
}

void sandbox_enter(int folder, struct sandbox_report *report)
{
	report->threads = threads_left();
	offer_to_oom_killer();
	enter_limits(&report->layers[SANDBOX_LIMITS]);
	enter_privileges(&report->layers[SANDBOX_PRIVILEGES]);
	enter_landlock(folder, report->threads, &report->layers[SANDBOX_LANDLOCK]);
	enter_seccomp(report->layers[SANDBOX_LANDLOCK].holds, &report->layers[SANDBOX_SECCOMP]);
}

void sandbox_try(struct sandbox_report *report)
{
	struct sandbox_state *landlock = &report->layers[SANDBOX_LANDLOCK], *seccomp = &report->layers[SANDBOX_SECCOMP];
	int fd = open("/", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (fd >= 0) {
		close(fd);
		if (landlock->holds)
			state(landlock, false, "it was put up, yet folders can still be listed");
	}
	fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
	if (fd >= 0) {
		close(fd);
		if (seccomp->holds)
			state(seccomp, false, "it was put up, yet sockets can still be made");
	}
}
