// What `candil doctor` looks at besides the devices. Each check fills in a plain record; none prints.
#ifndef CANDIL_CLI_DOCTOR_CHECKS_H
#define CANDIL_CLI_DOCTOR_CHECKS_H

#include "clients/cli/cli.h"
#include "clients/cli/programs.h"

struct program_check {
	const char *name;
	const char *purpose;
	bool needed; // for a render
	bool works; // it is there and starts
	char path[PROGRAM_PATH];
	char why[256]; // it does not
	char library[64]; // the shared library that it misses, "" if that is not the reason
};

// Start the program once with `argument`, which makes it end at once whatever its exit status.
void doctor_check_program(struct program_check *check, char *argument);

struct daemon_check {
	bool reachable;
	bool ready; // its worker has a device
	char address[256];
	char what[256]; // its name, or why it is not reachable
	char device[256]; // its worker's; not ready: why it has none
};
void doctor_check_daemon(struct daemon_check *check, const char *address);

struct kernel_check {
	bool memfd_sealing; // needed
	bool openat2; // needed: keeps side files beneath the scene's folder
	bool seccomp; // the kernel has it
	int landlock_abi; // 0: the kernel has none
};
void doctor_check_kernel(struct kernel_check *check);

struct cache_check {
	char path[PROGRAM_PATH]; // "" if there is no place for one
	bool writable; // without it every worker compiles its shaders anew
};
void doctor_check_cache(struct cache_check *check);

// Debian's package of a shared library's file name; NULL if unknown.
const char *doctor_package_of(const char *library);

#endif
