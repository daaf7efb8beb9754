// What the loader may still do once it has its descriptors: read beneath one folder, use a bounded amount of memory and
// time, make one memory file and send it. Four layers, each by what the kernel has; one that it lacks is reported, and the
// others are put up all the same.
//
// Design note. The layers come before the first byte of a scene is read, and in the one thread that there is then: threads
// that a library makes later inherit them. What libraries would open later (locales, plugins, /proc, /sys) is refused, and
// they do without.
#ifndef CANDIL_LOADER_SANDBOX_H
#define CANDIL_LOADER_SANDBOX_H

#include <stdbool.h>

enum sandbox_layer {
	SANDBOX_LIMITS, // memory, processor time, descriptors, file size, no core file
	SANDBOX_PRIVILEGES, // no new privileges, not to be traced
	SANDBOX_LANDLOCK, // files: only reading, only beneath the folder; no TCP, no signals to others
	SANDBOX_SECCOMP, // system calls: only those of a list
	SANDBOX_LAYERS
};

struct sandbox_state {
	bool holds;
	char detail[128]; // how far it goes, or why it does not hold
};

struct sandbox_report {
	struct sandbox_state layers[SANDBOX_LAYERS];
	int threads; // of this process as it entered, 1 unless a library has started more; -1 if unknown
};

const char *sandbox_layer_name(enum sandbox_layer layer);

// Confine this process for good. `folder` is what stays readable, O_PATH is enough; -1: nothing stays so. It and all other
// open descriptors stay the caller's and usable. Call once, while there is one thread.
void sandbox_enter(int folder, struct sandbox_report *report);

// Correct `report` by trying, in the sandbox, what each layer should refuse: a layer that was put up and refuses nothing
// does not hold.
void sandbox_try(struct sandbox_report *report);

#endif
