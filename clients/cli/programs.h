// Finding and running candil's other programs. They are found by the place of this executable: bin/candil, bin/candild,
// libexec/candil/….
#ifndef CANDIL_CLI_PROGRAMS_H
#define CANDIL_CLI_PROGRAMS_H

#include <spawn.h>
#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

#include "clients/libcandil/candil.h"

#define PROGRAM_PATH 4096

// The path of a program in libexec/candil, whether or not it exists. false: the place of this executable is unknown, or the
// path does not fit.
bool program_libexec(const char *name, char *path, size_t capacity);

// The path of candild beside this executable; if there is none, the bare name, which is looked for in PATH.
void program_daemon(char *path, size_t capacity);

// Is there room, under a limit of address space, for a program that links the image library? It would crash without. On
// failure `error` says what to do.
bool program_has_room(const char *name, struct candil_error *error);

// Start a program, which is looked for in PATH if argv[0] has no slash, without the interrupts that are held back here.
// After `actions`, which is the caller's to destroy, its standard input is empty, and of other descriptors it has `kept`
// from 3 on: what the caller of this program has left open is none of its business. In a process group of its own a Ctrl-C
// in the terminal does not reach it. Returns errno's value, 0 if it was started.
int program_start(char *const argv[], posix_spawn_file_actions_t *actions, int kept, bool own_group, pid_t *pid);

// How long a program may take: neither is a time of the clock, so a busy machine ends none.
struct program_time {
	unsigned still_ms; // without working or waiting for a processor or a disk (server/base/pulse.h)
	unsigned work_ms; // of work, in which several threads count as one
};

// Run a program with empty standard input; it is looked for in PATH if argv[0] has no slash. `out` and `err` get the first
// `capacity` - 1 bytes of each stream and a zero. The program is killed after its `time`. Returns its exit status, or 128
// plus the signal that ended it, or -1 with errno if it could not be started, did not end in time (ETIMEDOUT), or was killed
// for an interrupt (EINTR; interrupt.h).
int program_run(char *const argv[], struct program_time time, char *out, char *err, size_t capacity);

#endif
