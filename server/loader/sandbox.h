// Restricts what the loader may do once it has its descriptors: read beneath one folder, use a bounded amount of memory and
// time, make one memory file and send it. There are four layers. A layer that the kernel lacks is reported, and the others
// still apply.
//
// Design note. The layers are entered before the first byte of a scene is read, while there is a single thread; threads
// that a library creates later inherit them. What libraries would open later (locales, plugins, /proc, /sys) is refused,
// and they work without it.
#ifndef CANDIL_LOADER_SANDBOX_H
#define CANDIL_LOADER_SANDBOX_H

#include <stdbool.h>

enum sandbox_layer {
	SANDBOX_LIMITS, // limits of memory, processor time, descriptors and file size; no core file
	SANDBOX_PRIVILEGES, // no new privileges; cannot be traced
	SANDBOX_LANDLOCK, // files: reading only, beneath the folder only; no TCP, no signals to other processes
	SANDBOX_SECCOMP, // only the system calls of a list
	SANDBOX_LAYERS
};

struct sandbox_state {
	bool holds;
	char detail[128]; // how far it goes, or why it does not hold
};

struct sandbox_report {
	struct sandbox_state layers[SANDBOX_LAYERS];
	int threads; // number of threads on entry, 1 unless a library has started more; -1 if unknown
};

// The name of a layer. Static storage.
const char *sandbox_layer_name(enum sandbox_layer layer);

// Confine this process for good; the caller's *report receives each layer's state. `folder` stays readable; an O_PATH
// descriptor suffices, and -1 means that nothing stays readable. It and all other open descriptors remain the caller's and
// usable. Call once, while there is a single thread. Cannot fail as a whole.
void sandbox_enter(int folder, struct sandbox_report *report);

// Correct `report` by trying, in the sandbox, what each layer should refuse. A layer that was entered but refuses nothing
// does not hold.
void sandbox_try(struct sandbox_report *report);

#endif
