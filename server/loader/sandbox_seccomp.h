// The list of system calls that reading a scene needs. One thread.
#ifndef CANDIL_LOADER_SANDBOX_SECCOMP_H
#define CANDIL_LOADER_SANDBOX_SECCOMP_H

// Make every call that is not on the list fail with EPERM, in all threads of this process. A library that merely tries such
// a call then goes on without it. Requires PR_SET_NO_NEW_PRIVS. Returns 0 or an errno.
int seccomp_enter(void);

#endif
