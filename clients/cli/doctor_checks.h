// What `candil doctor` looks at besides the devices. Each check fills in a plain record; none prints.
#ifndef CANDIL_CLI_DOCTOR_CHECKS_H
#define CANDIL_CLI_DOCTOR_CHECKS_H

#include "clients/cli/cli.h"
#include "clients/cli/programs.h"
#include "protocol/limits.h"

// What a program has that doctor starts.
#define DOCTOR_TIME ((struct program_time){.still_ms = 1000 * LIMIT_HANG_SECONDS, .work_ms = 60000})

struct program_check {
	const char *name;
	const char *purpose;
	const char *user; // the only command that needs it; NULL: a render does
	bool works; // it is there and starts
	char path[PROGRAM_PATH];
	char why[256]; // why it does not work; "" if it does
	char library[64]; // the shared library that it misses, "" if that is not the reason
};

// Start the program with `argument`, with which it ends at once. Any exit status of its own counts as working.
void doctor_check_program(struct program_check *check, char *argument);

// What the kernel says of a process that serves.
struct process_check {
	const char *name;
	bool seen; // it runs where we can see it; what follows is of it
	bool no_new_privileges, no_capabilities, seccomp;
};

enum { DAEMON_PROCESSES = 2 }; // the front and its worker

struct daemon_check {
	bool reachable;
	bool ready; // its worker has a device
	char address[256];
	char what[256]; // its name, or why it is not reachable
	char device[256]; // the worker's device; if it is not ready, why it has none
	struct process_check processes[DAEMON_PROCESSES];
	uint32_t connections, scenes; // that its descriptors are enough for
	char note[256]; // a device was lost too often
};
// Connect to the daemon at `address`; NULL: the default one.
void doctor_check_daemon(struct daemon_check *check, const char *address);

struct kernel_check {
	bool memfd_sealing; // needed
	bool openat2; // needed: keeps side files beneath the scene's folder
	bool seccomp; // the kernel has it
	int landlock_abi; // 0: the kernel has none
};
void doctor_check_kernel(struct kernel_check *check);

// Debian's package of a shared library's file name; NULL if unknown.
const char *doctor_package_of(const char *library);

#endif
