// A seccomp list of what is refused, for programs whose needs nobody can list: a driver of another vendor or of next year
// makes calls of its own. The loader, of which more is known, has a list of what is allowed
// (server/loader/sandbox_seccomp.h).
//
// Design note. A filter is inherited by what a process starts. So the front's list has only what none of the three programs
// needs, and the worker adds to it.
#ifndef CANDIL_BASE_DENY_H
#define CANDIL_BASE_DENY_H

// Refuse with EPERM, in all threads of this process and for good, what none of our programs needs once it runs: sockets of
// any kind but pairs, tracing and reading of other processes, further namespaces, mounts and file handles, the kernel's
// modules, keys, programs and rings, owners, modes and attributes of files, and typing into the terminal. Requires
// PR_SET_NO_NEW_PRIVS. Returns 0 or an errno.
int deny_common(void);

// Refuse that, and programs, processes, and signals and limits for others: for one who only computes.
int deny_programs(void);

#endif
