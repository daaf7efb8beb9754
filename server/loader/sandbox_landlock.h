// Landlock by its system calls: Debian's C library has no functions for them.
#ifndef CANDIL_LOADER_SANDBOX_LANDLOCK_H
#define CANDIL_LOADER_SANDBOX_LANDLOCK_H

// Let this thread, and those it makes, read beneath `folder` (-1: nowhere) and do nothing else to any file. Needs
// PR_SET_NO_NEW_PRIVS. 0 with the kernel's ABI in *abi, or an errno: ENOSYS without landlock, EOPNOTSUPP where it is off.
int landlock_enter(int folder, int *abi);

#endif
