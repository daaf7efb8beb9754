// What the worker gives up before it opens a device: it may read programs, libraries, drivers' settings and what the kernel
// tells of devices, use the devices, and keep compiled shaders in one folder of its own. No other file, no network, no
// program, no other process. So who takes it over, by a driver's fault say, has a GPU and scenes, and nobody's keys.
//
// Design note. A driver starts threads, which landlock leaves alone if they are older. So the fence is put up first, and
// names by path what drivers open later (manifests.h, libraries.h, server/base/drivers.h). What a driver of a kind that
// nobody has tried needs besides, it does without: the loaders of Vulkan and EGL pass over what they cannot open.
#ifndef CANDIL_WORKER_FENCE_H
#define CANDIL_WORKER_FENCE_H

#include <limits.h>

#include "server/base/fence.h"

// What was put up, and where compiled shaders go.
struct worker_fence {
	struct fence_report report; // without FENCE_LIMITS
	char cache[PATH_MAX]; // where compiled shaders are kept; "": nowhere
	bool cache_writable; // and there is room
	bool cache_full; // there is none: drivers are told to keep nothing
};

// Make the folder of compiled shaders (server/base/drivers.h), which becomes $XDG_CACHE_HOME, and confine this process for
// good. Call once, while there is one thread and before a device is
// opened. Cannot fail as a whole. Sets environment variables.
void worker_fence_enter(struct worker_fence *fence);

#endif
