// What the front gives up before a child runs, and once it listens: new privileges and capabilities, sockets but those that
// it has, and with landlock all changes to files but those to what is learned, its socket, and what drivers write.
//
// Design note. The children inherit it, and beneath them are drivers of which nobody knows the needs. So it is a list of
// what is refused, and reading and starting programs stay open: where a client's scenes are, and a driver's libraries, is
// not known when the daemon starts. Loader and worker go further by themselves.
#ifndef CANDIL_FRONT_FENCE_H
#define CANDIL_FRONT_FENCE_H

#include "server/base/fence.h"
#include "server/front/options.h"

// Confine this process for good, and those that it will start, in all but system calls. Makes the folder of what is learned
// and that of compiled shaders. No child runs yet, for by landlock it could not be killed. One thread. Cannot fail as a
// whole.
void front_fence_enter(const struct options *options, struct fence_report *report);

// Confine it in system calls, too, after that: what it listens at is open by now.
void front_fence_stop_sockets(struct fence_report *report);

#endif
