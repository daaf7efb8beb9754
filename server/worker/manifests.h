// What Vulkan's loader and EGL's find drivers and layers by: manifests, small JSON files that name a library, in folders
// that the environment may name. One thread.
#ifndef CANDIL_WORKER_MANIFESTS_H
#define CANDIL_WORKER_MANIFESTS_H

#include "server/base/landlock.h"

// Allow reading the manifests of all places where the two loaders look, and the libraries that they name with those that
// these need (libraries.h).
void manifests_allow(struct landlock *l);

#endif
