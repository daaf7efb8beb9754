// Landlock by its system calls: Debian's C library has no functions for them. One thread.
#ifndef CANDIL_LOADER_SANDBOX_LANDLOCK_H
#define CANDIL_LOADER_SANDBOX_LANDLOCK_H

// Restrict this thread, and those that it creates, to reading beneath `folder` (-1: nowhere); any other access to files is
// refused. Requires PR_SET_NO_NEW_PRIVS. Returns 0, with the kernel's ABI in *abi, or an errno: ENOSYS if there is no
// landlock, EOPNOTSUPP if it is off.
int landlock_enter(int folder, int *abi);

#endif
