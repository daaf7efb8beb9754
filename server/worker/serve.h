// The worker's loop: it takes the front's orders and answers them. The thread that calls serve is the device's thread: all
// work on the device happens on it.
#ifndef CANDIL_WORKER_SERVE_H
#define CANDIL_WORKER_SERVE_H

#include "server/base/error.h"

struct devices;

// Serve the front at `socket` (SOCK_SEQPACKET, messages of server/base/ipc.h) until it closes. `socket` and `devices` stay
// the caller's. devices->vk NULL: there is no device, and every job is refused with the reason in `why`. Returns STATUS_OK
// when the front has gone; STATUS_DEVICE when the device was lost: the process should then end, so that the front starts
// another.
enum status serve(int socket, struct devices *devices, const struct error *why);

// Compile what the first job that the front begins needs, and send nothing: the driver's cache and the list of code
// (code_list.h) are what comes of it. As `serve` in all else.
enum status serve_compiling(int socket, struct devices *devices);

#endif
