#include "server/loader/sandbox_seccomp.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/prctl.h>
#include <sched.h>
#include <seccomp.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/mman.h>
#include <unistd.h>

#include "server/base/ipc.h"

// Calls that are allowed with any arguments. By name, because not every architecture and kernel header has all of them.
static const char *const calls[] = {
    // open files, the folder and the names in it (only openat2, whose flags are left to landlock)
    "read",
    "readv",
    "pread64",
    "preadv",
    "write",
    "writev",
    "close",
    "fstat",
    "newfstatat",
    "statx",
    "lseek",
    "openat2",
    "getdents64",
    // memory
    "munmap",
    "mremap",
    "madvise",
    "brk",
    "membarrier",
    // the blob
    "memfd_create",
    "ftruncate",
    // threads, their locks and clocks
    "futex",
    "set_robust_list",
    "rseq",
    "set_tid_address",
    "gettid",
    "getpid",
    "sched_yield",
    "sched_getaffinity",
    "getcpu",
    "clock_gettime",
    "clock_getres",
    "clock_nanosleep",
    "nanosleep",
    "gettimeofday",
    "time",
    "getrusage",
    "times",
    "restart_syscall",
    // its own signals and end
    "rt_sigaction",
    "rt_sigprocmask",
    "rt_sigreturn",
    "sigaltstack",
    "exit",
    "exit_group",
    // harmless queries
    "getrandom",
    "sysinfo",
    "uname",
    "getuid",
    "geteuid",
    "getgid",
    "getegid",
#ifdef __SANITIZE_ADDRESS__
    // the leak check: a process that shares this one's memory and traces it
    "clone",
    "ptrace",
    "wait4",
    "getppid",
    "readlink",
    "readlinkat",
    "open",
    "openat",
    "access",
    "getdents",
    "prctl",
    "ioctl",
    "process_vm_readv",
    "pipe",
    "pipe2",
    "dup",
    "kill",
    "tgkill",
    "prlimit64",
    "getrlimit",
    "fcntl",
#endif
};

static int allow_calls(scmp_filter_ctx filter)
{
	int failed = 0;
	for (size_t i = 0; i < sizeof calls / sizeof calls[0] && !failed; i++) {
		const int call = seccomp_syscall_resolve_name(calls[i]);
		if (call != __NR_SCMP_ERROR)
			failed = seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, 0);
		if (failed == -EDOM) // the architecture has no call of that name
			failed = 0;
	}
	return failed;
}

static int allow_file_control(scmp_filter_ctx filter)
{
	static const scmp_datum_t commands[] = {F_GETFD, F_SETFD, F_GETFL, F_ADD_SEALS, F_GET_SEALS};
	int failed = 0;
	for (size_t i = 0; i < sizeof commands / sizeof commands[0] && !failed; i++)
		failed =
		    seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(fcntl), 1, SCMP_A1_32(SCMP_CMP_EQ, commands[i], 0));
	return failed;
}

// Calls that are allowed with certain arguments: opening for reading, memory that is not executable, threads but not
// processes, the one socket, reading limits but not setting them, signals to itself.
static int allow_some(scmp_filter_ctx f)
{
	const struct scmp_arg_cmp read_only = SCMP_A2_32(
	    SCMP_CMP_MASKED_EQ, (scmp_datum_t)(O_ACCMODE | O_CREAT | O_TRUNC | (O_TMPFILE & ~O_DIRECTORY)), O_RDONLY);
	const struct scmp_arg_cmp no_code = SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0);
	const struct scmp_arg_cmp thread =
	    SCMP_A0(SCMP_CMP_MASKED_EQ, CLONE_THREAD | CLONE_VM | CLONE_SIGHAND, CLONE_THREAD | CLONE_VM | CLONE_SIGHAND);
	const struct scmp_arg_cmp to_front = SCMP_A0_32(SCMP_CMP_EQ, IPC_FD, 0);
	const struct scmp_arg_cmp nothing_new = SCMP_A2(SCMP_CMP_EQ, 0, 0);
	const struct scmp_arg_cmp own_name = SCMP_A0_32(SCMP_CMP_EQ, PR_SET_NAME, 0);
	const struct scmp_arg_cmp memory_name = SCMP_A0_32(SCMP_CMP_EQ, PR_SET_VMA, 0);
	const struct scmp_arg_cmp filter_state = SCMP_A0_32(SCMP_CMP_EQ, PR_GET_SECCOMP, 0);
	const struct scmp_arg_cmp itself = SCMP_A0_32(SCMP_CMP_EQ, (scmp_datum_t)getpid(), 0);
	int failed = 0;

#define ALLOW_IF(call, condition) \
	if (!failed) \
	failed = seccomp_rule_add(f, SCMP_ACT_ALLOW, SCMP_SYS(call), 1, condition)
	ALLOW_IF(openat, read_only);
	ALLOW_IF(mmap, no_code);
	ALLOW_IF(mprotect, no_code);
	ALLOW_IF(clone, thread);
	ALLOW_IF(sendmsg, to_front);
	ALLOW_IF(prlimit64, nothing_new);
	ALLOW_IF(prctl, own_name);
	ALLOW_IF(prctl, memory_name);
	ALLOW_IF(prctl, filter_state);
	ALLOW_IF(tgkill, itself);
#undef ALLOW_IF
	// The C library then falls back to clone, whose flags a filter can see.
	if (!failed)
		failed = seccomp_rule_add(f, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0);
	return failed;
}

int seccomp_enter(void)
{
	scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
	if (!filter)
		return ENOMEM;
	seccomp_attr_set(filter, SCMP_FLTATR_API_SYSRAWRC, 1); // return the kernel's own errno
	seccomp_attr_set(filter, SCMP_FLTATR_CTL_TSYNC, 1); // all threads, if there is more than one
	seccomp_attr_set(filter, SCMP_FLTATR_CTL_OPTIMIZE, 2); // a tree, because a long load makes many calls
	int failed = allow_some(filter);
	if (!failed)
		failed = allow_calls(filter);
	if (!failed)
		failed = allow_file_control(filter);
	if (!failed)
		failed = seccomp_load(filter);
	seccomp_release(filter);
	return -failed;
}
