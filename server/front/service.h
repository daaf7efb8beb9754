// The daemon: what listens, who is connected, which scenes and jobs there are, and the worker.
#ifndef CANDIL_FRONT_SERVICE_H
#define CANDIL_FRONT_SERVICE_H

#include "server/front/options.h"

// Serve until SIGTERM or SIGINT comes or, with a private connection, until that ends. The thread that calls it becomes the
// front's one thread (loop.h), and there must be no other. `options` must outlive the call, which takes over its private_fd.
// For the whole process it blocks SIGTERM and SIGINT, ignores SIGPIPE and resets SIGCHLD. STATUS_OK is an orderly end.
// Failures: STATUS_CONNECT (cannot listen), STATUS_SCENE_PATH (--scene-root), whatever the load of a --scene failed with,
// STATUS_MEMORY, STATUS_INTERNAL.
enum status service_run(const struct options *options, struct error *err);

#endif
