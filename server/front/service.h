// The daemon: what listens, who is connected, which scenes and jobs there are, and the worker. Its messages come in here.
#ifndef CANDIL_FRONT_SERVICE_H
#define CANDIL_FRONT_SERVICE_H

#include "server/front/options.h"

// Serve until SIGTERM, SIGINT or, for a private connection, its end. `options` must outlive the call. STATUS_OK is an
// orderly end. Blocks SIGTERM and SIGINT and ignores SIGPIPE for the whole process.
enum status service_run(const struct options *options, struct error *err);

#endif
