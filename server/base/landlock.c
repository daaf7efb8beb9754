#include "server/base/landlock.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/landlock.h>
#include <stdint.h>
#include <sys/stat.h>
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

#define READING (LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR)
#define WRITING (LANDLOCK_ACCESS_FS_WRITE_FILE | FILES_TRUNCATE)

// Rights that a rule may grant for what is no folder.
#define OF_FILES (LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_READ_FILE | WRITING | FILES_IOCTL_DEV)

static uint64_t files_of(int abi)
{
	return FILES_ABI_1 | (abi >= 2 ? FILES_REFER : 0) | (abi >= 3 ? FILES_TRUNCATE : 0) |
	       (abi >= 5 ? FILES_IOCTL_DEV : 0);
}

static size_t ruleset_for(int abi, enum landlock_scope scope, struct ruleset *r)
{
	*r = (struct ruleset){
	    .files = files_of(abi),
	    .net = abi >= 4 ? NET_BIND_AND_CONNECT_TCP : 0,
	    .scoped = abi >= 6 ? SCOPED_SOCKETS_AND_SIGNALS : 0,
	};
	if (scope == SCOPE_CHANGES)
		r->files &= ~(uint64_t)(READING | LANDLOCK_ACCESS_FS_EXECUTE);
	return abi >= 6 ? sizeof *r : abi >= 4 ? 2 * sizeof(uint64_t) : sizeof(uint64_t);
}

void landlock_begin(struct landlock *l, enum landlock_scope scope)
{
	struct ruleset rules;
	*l = (struct landlock){.ruleset = -1};
	const long abi = syscall(SYS_landlock_create_ruleset, NULL, (size_t)0, LANDLOCK_CREATE_RULESET_VERSION);
	if (abi < 1) {
		l->failed = abi < 0 ? errno : ENOSYS;
		return;
	}
	l->abi = (int)abi;
	const size_t size = ruleset_for(l->abi, scope, &rules);
	l->ruleset = (int)syscall(SYS_landlock_create_ruleset, &rules, size, 0);
	if (l->ruleset < 0)
		l->failed = errno;
	l->handled = rules.files;
}

static uint64_t rights_of(enum landlock_use use)
{
	switch (use) {
	case USE_READ:
		return READING;
	case USE_KEEP:
		return READING | WRITING | LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_MAKE_DIR |
		       LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR | FILES_REFER;
	case USE_DEVICE:
		return READING | WRITING | FILES_IOCTL_DEV;
	case USE_SOCKET:
		return LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_REMOVE_FILE;
	}
	return 0;
}

void landlock_allow_fd(struct landlock *l, int fd, enum landlock_use use)
{
	struct stat about;
	if (l->ruleset < 0 || l->failed || fstat(fd, &about) != 0)
		return;
	const struct landlock_path_beneath_attr rule = {
	    .allowed_access = rights_of(use) & l->handled & (S_ISDIR(about.st_mode) ? ~0ull : OF_FILES),
	    .parent_fd = fd,
	};
	if (rule.allowed_access && syscall(SYS_landlock_add_rule, l->ruleset, LANDLOCK_RULE_PATH_BENEATH, &rule, 0) != 0)
		l->failed = errno;
}

void landlock_allow(struct landlock *l, const char *path, enum landlock_use use)
{
	const int fd = l->ruleset >= 0 ? open(path, O_PATH | O_CLOEXEC) : -1;
	if (fd < 0)
		return;
	landlock_allow_fd(l, fd, use);
	close(fd);
}

int landlock_enter(struct landlock *l)
{
	if (!l->failed && syscall(SYS_landlock_restrict_self, l->ruleset, 0) != 0)
		l->failed = errno;
	if (l->ruleset >= 0)
		close(l->ruleset);
	l->ruleset = -1;
	return l->failed;
}
