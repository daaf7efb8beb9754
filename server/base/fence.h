// What a process gives up for good, in layers, so that whoever takes it over has little. Each program puts up a fence of its
// own: the loader in server/loader/sandbox.h, the worker in server/worker/fence.h, the front in server/front/fence.h; what
// they share is here. A layer that the kernel lacks is reported, and the others still hold. One thread.
#ifndef CANDIL_BASE_FENCE_H
#define CANDIL_BASE_FENCE_H

#include <stdbool.h>

enum fence_layer {
	FENCE_LIMITS, // of memory, processor time, descriptors and file size; no core file
	FENCE_PRIVILEGES, // no new ones, no capabilities
	FENCE_LANDLOCK, // files, TCP, signals to others
	FENCE_SECCOMP, // system calls
	FENCE_LAYERS
};

struct fence_state {
	bool holds;
	char detail[128]; // how far it goes, or why it does not hold; "": the program has no such layer
};

struct fence_report {
	struct fence_state layers[FENCE_LAYERS];
	int threads; // on entry, 1 unless a library has started more; -1 if unknown
};

// The name of a layer. Static storage.
const char *fence_layer_name(enum fence_layer layer);

// Write a layer's state.
void fence_state_set(struct fence_state *state, bool holds, const char *format, ...) __attribute__((format(printf, 3, 4)));

// Write what became of landlock: `failed` is what landlock_enter (landlock.h) returned, `abi` the kernel's. It holds for
// this thread and those that it makes later, so not as a whole if there are others.
void fence_state_landlock(struct fence_state *state, int failed, int abi, int threads);

// Write what became of seccomp: `failed` is what deny.h returned.
void fence_state_deny(struct fence_state *state, int failed);

// Number of threads of this process; -1 if unknown.
int fence_threads(void);

// Never gain a privilege by starting a program, and drop all capabilities: root's process then has the rights of files that
// root owns, and no more. Landlock and seccomp need it to have been called.
void fence_privileges(struct fence_state *state);

// Correct `report` by trying, inside, what the last two layers should refuse: a layer that was put up but refuses nothing
// does not hold.
void fence_try(struct fence_report *report);

// Say in the log which layers do not hold.
void fence_log(const struct fence_report *report);

#endif
