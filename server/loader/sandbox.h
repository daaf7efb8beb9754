// Restricts what the loader may do once it has its descriptors: read beneath one folder, use a bounded amount of memory and
// time, make one memory file and send it. There are all four layers of fence.h: limits; no new privileges, no capabilities
// and no tracing; landlock that leaves reading beneath the folder; and the list of sandbox_seccomp.h.
//
// Design note. The layers are entered before the first byte of a scene is read, while there is a single thread; threads
// that a library creates later inherit them. What libraries would open later (locales, plugins, /proc, /sys) is refused,
// and they work without it.
#ifndef CANDIL_LOADER_SANDBOX_H
#define CANDIL_LOADER_SANDBOX_H

#include "server/base/fence.h"

// Confine this process for good; the caller's *report receives each layer's state. `folder` stays readable; an O_PATH
// descriptor suffices, and -1 means that nothing stays readable. It and all other open descriptors remain the caller's and
// usable. Call once, while there is a single thread. Cannot fail as a whole.
void sandbox_enter(int folder, struct fence_report *report);

#endif
