#include "server/base/fence.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/capability.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "server/base/log.h"

#ifdef __SANITIZE_ADDRESS__
enum { SANITIZED = 1 };
#else
enum { SANITIZED = 0 };
#endif

const char *fence_layer_name(enum fence_layer layer)
{
	static const char *const names[FENCE_LAYERS] = {
	    [FENCE_LIMITS] = "limits",
	    [FENCE_PRIVILEGES] = "privileges",
	    [FENCE_LANDLOCK] = "landlock",
	    [FENCE_SECCOMP] = "seccomp",
	};
	return names[layer];
}

void fence_state_set(struct fence_state *state, bool holds, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	state->holds = holds;
	vsnprintf(state->detail, sizeof state->detail, format, arguments);
	va_end(arguments);
}

void fence_state_landlock(struct fence_state *state, int failed, int abi, int threads)
{
	if (failed == 0 && threads > 1)
		fence_state_set(state, false, "it confines one thread of %d that libraries have started", threads);
	else if (failed == ENOSYS)
		fence_state_set(state, false, "the kernel has no landlock, or something filters it away");
	else if (failed == EOPNOTSUPP)
		fence_state_set(state, false, "the kernel has landlock, but it was not enabled at boot (lsm=landlock,...)");
	else if (failed)
		fence_state_set(state, false, "landlock: %s", strerror(failed));
	else
		fence_state_set(state, true, "ABI %d", abi);
}

void fence_state_deny(struct fence_state *state, int failed)
{
	if (failed)
		fence_state_set(state, false, "the kernel does not take the filter: %s", strerror(failed));
	else
		fence_state_set(state, true, "a list of what is refused%s",
				SANITIZED ? ", shorter under AddressSanitizer" : "");
}

int fence_threads(void)
{
	struct stat tasks;
	return stat("/proc/self/task", &tasks) == 0 ? (int)tasks.st_nlink - 2 : -1;
}

// By the system call: what a library would add to it is for those who keep some.
static int drop_capabilities(void)
{
	struct __user_cap_header_struct head = {.version = _LINUX_CAPABILITY_VERSION_3};
	const struct __user_cap_data_struct none[_LINUX_CAPABILITY_U32S_3] = {0};
	// Only who has CAP_SETPCAP can and needs to: the bounding set is what root's next program would have again.
	for (unsigned long capability = 0; prctl(PR_CAPBSET_READ, capability, 0, 0, 0) >= 0; capability++)
		(void)prctl(PR_CAPBSET_DROP, capability, 0, 0, 0);
	return syscall(SYS_capset, &head, none) == 0 ? 0 : errno;
}

void fence_privileges(struct fence_state *state)
{
	int failed;
	if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0)
		fence_state_set(state, false, "no_new_privs: %s", strerror(errno));
	else if ((failed = drop_capabilities()) != 0)
		fence_state_set(state, false, "no new ones; capabilities are kept: %s", strerror(failed));
	else
		fence_state_set(state, true, "no new ones, no capabilities");
}

void fence_try(struct fence_report *report)
{
	struct fence_state *landlock = &report->layers[FENCE_LANDLOCK], *seccomp = &report->layers[FENCE_SECCOMP];
	int fd = open("/", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (fd >= 0) {
		close(fd);
		if (landlock->holds)
			fence_state_set(landlock, false, "it was put up, yet folders can still be listed");
	}
	fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
	if (fd >= 0) {
		close(fd);
		if (seccomp->holds)
			fence_state_set(seccomp, false, "it was put up, yet sockets can still be made");
	}
}

void fence_log(const struct fence_report *report)
{
	for (int i = 0; i < FENCE_LAYERS; i++)
		if (report->layers[i].detail[0] && !report->layers[i].holds)
			log_line(LOG_WARNING, "fence: %s does not hold: %s", fence_layer_name((enum fence_layer)i),
				 report->layers[i].detail);
}
