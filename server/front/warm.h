// Making ready: one picture by each technique of the scenes of --warm, which nobody sees. Shader code is compiled for them,
// and what techniques keep with a scene is built, before the first client comes.
//
// For the front's one thread (loop.h).
#ifndef CANDIL_FRONT_WARM_H
#define CANDIL_FRONT_WARM_H

#include "server/base/error.h"

struct service;

// Begin to ask for the pictures, as a client whose replies nobody reads: service->warming is its session while they are
// under way. Failures: STATUS_MEMORY, STATUS_INTERNAL.
enum status warm_begin(struct service *service, struct error *err);

// Go on with it, in each turn of the loop. True once: they are all there, or have failed, and the log says how many.
bool warm_is_done(struct service *service);

#endif
