#include "server/base/deny.h"

#include <errno.h>
#include <sched.h>
#include <seccomp.h>
#include <stdbool.h>
#include <stddef.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

// A call by its name, because not every architecture has all of them; and its number where libseccomp may be older than the
// call. Calls that came after 2019 have one number everywhere.
struct call {
	const char *name;
	int number; // 0: libseccomp knows it
};

static const struct call common[] = {
    // the network, and local services that would do for us what we may not
    {"socket", 0},
    {"connect", 0},
    {"bind", 0},
    {"listen", 0},
    // other processes
    {"process_vm_writev", 0},
    {"process_madvise", 440},
    {"pidfd_getfd", 438},
    {"setns", 0},
    {"unshare", 0},
    // memory and queues that all processes of the user share by number or name
    {"shmget", 0},
    {"shmat", 0},
    {"shmctl", 0},
    {"msgget", 0},
    {"msgsnd", 0},
    {"msgrcv", 0},
    {"msgctl", 0},
    {"semget", 0},
    {"semop", 0},
    {"semtimedop", 0},
    {"semctl", 0},
    {"mq_open", 0},
    {"mq_unlink", 0},
    // files by other ways than their names, and file systems
    {"open_by_handle_at", 0},
    {"mount", 0},
    {"umount", 0},
    {"umount2", 0},
    {"pivot_root", 0},
    {"chroot", 0},
    {"open_tree", 428},
    {"move_mount", 429},
    {"fsopen", 430},
    {"fsconfig", 431},
    {"fsmount", 432},
    {"fspick", 433},
    {"mount_setattr", 442},
    {"open_tree_attr", 467},
    {"quotactl", 0},
    {"quotactl_fd", 443},
    {"fanotify_init", 0},
    {"swapon", 0},
    {"swapoff", 0},
    {"acct", 0},
    // lengths and attributes of files, of which landlock knows nothing, or not from the beginning
    {"truncate", 0},
    {"truncate64", 0},
    {"chmod", 0},
    {"fchmod", 0},
    {"fchmodat", 0},
    {"fchmodat2", 452},
    {"chown", 0},
    {"lchown", 0},
    {"fchown", 0},
    {"fchownat", 0},
    {"setxattr", 0},
    {"lsetxattr", 0},
    {"fsetxattr", 0},
    {"setxattrat", 463},
    {"removexattr", 0},
    {"lremovexattr", 0},
    {"fremovexattr", 0},
    {"removexattrat", 466},
    {"file_setattr", 469},
    // doors to the kernel that have been left open before
    {"bpf", 0},
    {"perf_event_open", 0},
    {"userfaultfd", 0},
    {"io_uring_setup", 425},
    {"io_uring_enter", 426},
    {"io_uring_register", 427},
    {"add_key", 0},
    {"request_key", 0},
    {"keyctl", 0},
    {"init_module", 0},
    {"finit_module", 0},
    {"delete_module", 0},
    {"kexec_load", 0},
    {"kexec_file_load", 0},
    {"iopl", 0},
    {"ioperm", 0},
    {"modify_ldt", 0},
    {"vm86", 0},
    {"syslog", 0},
    {"reboot", 0},
    {"settimeofday", 0},
    {"clock_settime", 0},
    {"adjtimex", 0},
    {"clock_adjtime", 0},
    {"sethostname", 0},
    {"setdomainname", 0},
    {"vhangup", 0},
#ifndef __SANITIZE_ADDRESS__ // the leak check traces its own process
    {"ptrace", 0},
    {"process_vm_readv", 0},
#endif
};

static const struct call programs[] = {
    {"execve", 0}, {"execveat", 0}, {"accept", 0}, {"accept4", 0}, {"tkill", 0}, {"pidfd_send_signal", 424},
#ifndef __SANITIZE_ADDRESS__
    {"fork", 0},   {"vfork", 0},
#endif
};

static int deny_calls(scmp_filter_ctx f, const struct call *calls, size_t count)
{
	int failed = 0;
	for (size_t i = 0; i < count && !failed; i++) {
		int call = seccomp_syscall_resolve_name(calls[i].name);
		if (call == __NR_SCMP_ERROR)
			call = calls[i].number;
		if (call != 0)
			failed = seccomp_rule_add(f, SCMP_ACT_ERRNO(EPERM), call, 0);
		if (failed == -EDOM) // the architecture has no call of that name
			failed = 0;
	}
	return failed;
}

#define DENY_IF(call, condition) \
	if (!failed) \
	failed = seccomp_rule_add(f, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(call), 1, condition)

static int deny_some_to_all(scmp_filter_ctx f)
{
	const struct scmp_arg_cmp not_local = SCMP_A0_32(SCMP_CMP_NE, AF_UNIX, 0);
	const struct scmp_arg_cmp other_users = SCMP_A0(SCMP_CMP_MASKED_EQ, CLONE_NEWUSER, CLONE_NEWUSER);
	const struct scmp_arg_cmp typing = SCMP_A1_32(SCMP_CMP_EQ, TIOCSTI, 0);
	const struct scmp_arg_cmp selecting = SCMP_A1_32(SCMP_CMP_EQ, TIOCLINUX, 0);
	int failed = 0;
	DENY_IF(socketpair, not_local);
	DENY_IF(clone, other_users);
	DENY_IF(ioctl, typing);
	DENY_IF(ioctl, selecting);
	// The C library then falls back to clone, whose flags a filter can see.
	if (!failed)
		failed = seccomp_rule_add(f, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0);
	return failed;
}

static int deny_some_to_one(scmp_filter_ctx f)
{
	const scmp_datum_t self = (scmp_datum_t)getpid();
	const struct scmp_arg_cmp another = SCMP_A0_32(SCMP_CMP_NE, self, 0);
	const struct scmp_arg_cmp not_zero = SCMP_A0_32(SCMP_CMP_NE, 0, 0);
	int failed = 0;
	DENY_IF(prlimit64, not_zero);
	DENY_IF(rt_sigqueueinfo, another);
	DENY_IF(rt_tgsigqueueinfo, another);
#ifndef __SANITIZE_ADDRESS__
	const struct scmp_arg_cmp process = SCMP_A0(SCMP_CMP_MASKED_EQ, CLONE_THREAD, 0);
	DENY_IF(clone, process);
	DENY_IF(kill, another);
	DENY_IF(tgkill, another);
#endif
	return failed;
}

static int deny(bool also_programs)
{
	scmp_filter_ctx f = seccomp_init(SCMP_ACT_ALLOW);
	if (!f)
		return ENOMEM;
	seccomp_attr_set(f, SCMP_FLTATR_API_SYSRAWRC, 1); // return the kernel's own errno
	seccomp_attr_set(f, SCMP_FLTATR_CTL_TSYNC, 1); // all threads, if there is more than one
	seccomp_attr_set(f, SCMP_FLTATR_CTL_OPTIMIZE, 2); // a tree
	int failed = deny_calls(f, common, sizeof common / sizeof common[0]);
	if (!failed)
		failed = deny_some_to_all(f);
	if (!failed && also_programs)
		failed = deny_calls(f, programs, sizeof programs / sizeof programs[0]);
	if (!failed && also_programs)
		failed = deny_some_to_one(f);
	if (!failed)
		failed = seccomp_load(f);
	seccomp_release(f);
	return -failed;
}

int deny_common(void)
{
	return deny(false);
}

int deny_programs(void)
{
	return deny(true);
}
