#include "server/loader/sandbox_landlock.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/landlock.h>
#include <stdint.h>
#include <sys/syscall.h>
#include <unistd.h>

// The kernel's structure as of ABI 6. Debian's header stops at ABI 2. A kernel is passed only the part that its ABI has.
struct ruleset {
	uint64_t files; // rights that are refused unless a rule grants them
	uint64_t net; // from ABI 4
	uint64_t scoped; // from ABI 6
};

#define FILES_ABI_1 ((1ull << 13) - 1) // execute, write, read, list, remove and make of all kinds
#define FILES_REFER (1ull << 13) // ABI 2
#define FILES_TRUNCATE (1ull << 14) // ABI 3
#define FILES_IOCTL_DEV (1ull << 15) // ABI 5
#define NET_BIND_AND_CONNECT_TCP 3ull // ABI 4
#define SCOPED_SOCKETS_AND_SIGNALS 3ull // ABI 6

static size_t ruleset_for(int abi, struct ruleset *r)
{
	*r = (struct ruleset){
	    .files = FILES_ABI_1 | (abi >= 2 ? FILES_REFER : 0) | (abi >= 3 ? FILES_TRUNCATE : 0) |
		     (abi >= 5 ? FILES_IOCTL_DEV : 0),
	    .net = abi >= 4 ? NET_BIND_AND_CONNECT_TCP : 0,
	    .scoped = abi >= 6 ? SCOPED_SOCKETS_AND_SIGNALS : 0,
	};
	return abi >= 6 ? sizeof *r : abi >= 4 ? 2 * sizeof(uint64_t) : sizeof(uint64_t);
}

static int allow_reading(int ruleset, int folder)
{
	const struct landlock_path_beneath_attr rule = {
	    .allowed_access = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR,
	    .parent_fd = folder,
	};
	return syscall(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &rule, 0) == 0 ? 0 : errno;
}

// The leak check at the end of a program reads the process's own maps and threads in /proc.
static int allow_sanitizer(int ruleset)
{
	int failed = 0;
#ifdef __SANITIZE_ADDRESS__
	const int proc = open("/proc", O_PATH | O_DIRECTORY | O_CLOEXEC);
	if (proc >= 0) {
		failed = allow_reading(ruleset, proc);
		close(proc);
	}
#else
	(void)ruleset;
#endif
	return failed;
}

int landlock_enter(int folder, int *abi)
{
	struct ruleset rules;
	*abi = (int)syscall(SYS_landlock_create_ruleset, NULL, (size_t)0, LANDLOCK_CREATE_RULESET_VERSION);
	if (*abi < 1)
		return *abi < 0 ? errno : ENOSYS;
	const size_t size = ruleset_for(*abi, &rules);
	const int ruleset = (int)syscall(SYS_landlock_create_ruleset, &rules, size, 0);
	if (ruleset < 0)
		return errno;
	int failed = folder >= 0 ? allow_reading(ruleset, folder) : 0;
	if (!failed)
		failed = allow_sanitizer(ruleset);
	if (!failed && syscall(SYS_landlock_restrict_self, ruleset, 0) != 0)
		failed = errno;
	close(ruleset);
	return failed;
}
