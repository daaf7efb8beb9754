// Where candil's other programs are, and running them. Everything is looked for from this executable's own place:
// bin/candil, bin/candild, libexec/candil/….
#ifndef CANDIL_CLI_PROGRAMS_H
#define CANDIL_CLI_PROGRAMS_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

#define PROGRAM_PATH 4096

// Path of a program in libexec/candil, whether or not it is there. false: this executable's own place is unknown.
bool program_libexec(const char *name, char *path, size_t capacity);

// Path of candild: beside this executable, else the bare name, for PATH.
void program_daemon(char *path, size_t capacity);

// Run a program (looked for in PATH if argv[0] has no slash) with its standard input empty and collect what it writes, at
// most `capacity` - 1 bytes of each stream, the rest dropped; both are terminated. Killed after timeout_ms. Returns its exit
// status, 128 + signal, or -1 if it could not be started (errno) or did not end in time (errno ETIMEDOUT).
int program_run(char *const argv[], int timeout_ms, char *out, char *err, size_t capacity);

#endif
