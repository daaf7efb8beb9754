// The list of system calls that reading a scene takes.
#ifndef CANDIL_LOADER_SANDBOX_SECCOMP_H
#define CANDIL_LOADER_SANDBOX_SECCOMP_H

// Refuse this process, all its threads, every call that is not on the list: with EPERM, so that a library that merely asks
// goes on without. Needs PR_SET_NO_NEW_PRIVS. 0 or an errno.
int seccomp_enter(void);

#endif
