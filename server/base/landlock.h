// Landlock by its system calls: Debian's C library has no functions for them. One thread.
//
//     struct landlock l;
//     landlock_begin(&l, SCOPE_ALL);
//     landlock_allow(&l, "/usr", USE_READ);
//     const int failed = landlock_enter(&l);
#ifndef CANDIL_BASE_LANDLOCK_H
#define CANDIL_BASE_LANDLOCK_H

#include <stdint.h>

enum landlock_scope {
	SCOPE_ALL, // all access to files, TCP, abstract sockets and signals to processes outside
	SCOPE_CHANGES, // the same, but files may be read and started
};

enum landlock_use {
	USE_READ, // files and folders
	USE_KEEP, // read, write, make and remove files and folders; nothing is started
	USE_DEVICE, // read, write and control a device
	USE_SOCKET, // make and remove sockets
};

struct landlock {
	int abi; // of the kernel; 0: none
	int ruleset; // -1: none
	uint64_t handled; // rights that are refused without a rule
	int failed; // an errno, 0: none so far
};

// Begin a list of what stays allowed of `scope`; nothing does yet. What fails is told by landlock_enter.
void landlock_begin(struct landlock *l, enum landlock_scope scope);

// Allow a use of the file or folder, and of all beneath it. A path that is not there is passed over; one that is a link
// means what it leads to. An O_PATH descriptor suffices and stays the caller's.
void landlock_allow(struct landlock *l, const char *path, enum landlock_use use);
void landlock_allow_fd(struct landlock *l, int fd, enum landlock_use use);

// Confine this thread, and those that it makes later, for good, and end the list. What is open stays open. Requires
// PR_SET_NO_NEW_PRIVS. Returns 0 or an errno: ENOSYS if there is no landlock, EOPNOTSUPP if it is off.
int landlock_enter(struct landlock *l);

#endif
