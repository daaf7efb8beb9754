// The worker's GPU through its two APIs. Vulkan is open from the start. OpenGL is opened by the first job whose technique
// needs it, because it costs memory and time that users of the path tracer do not need to spend. Device's thread only.
#ifndef CANDIL_WORKER_DEVICES_H
#define CANDIL_WORKER_DEVICES_H

#include <stdint.h>

#include "server/base/error.h"
#include "server/worker/code_list.h"

struct device; // vk/device.h
struct gl_device; // gl/device.h

// Both devices, owned here.
struct devices {
	struct device *vk; // NULL: there is none, and nothing renders
	struct gl_device *gl; // NULL: not opened yet
	uint64_t open_us; // that opening it took; 0: not opened yet
	struct code_list code; // what the driver has compiled before; `vk` and `gl` point at it
};

// The OpenGL device, opened if it was not: on the GPU of `vk`, which must be open, and within its memory budget. It stays
// this struct's. STATUS_DEVICE if there is none; STATUS_MEMORY.
enum status devices_gl(struct devices *devices, struct gl_device **gl, struct error *err);

// Close both, with the programs and pipelines that they keep. Everything else made on them must have been freed before.
void devices_finish(struct devices *devices);

#endif
