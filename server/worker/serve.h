// The worker's loop: orders from the front in, answers out. Everything on the device happens here, on this one thread.
#ifndef CANDIL_WORKER_SERVE_H
#define CANDIL_WORKER_SERVE_H

#include "server/base/error.h"

struct devices;

// Serve the front at `socket` until it closes. `devices->vk` NULL: there is no device, for the reason in `why`; every job is
// then refused with it. STATUS_OK when the front has gone; STATUS_DEVICE when the device was lost, and the process should
// end so that the front starts another.
enum status serve(int socket, struct devices *devices, const struct error *why);

#endif
