// The two faces of the worker's GPU. Vulkan is open from the start; OpenGL opens with the first job whose technique needs
// it, for it costs memory and time that a path tracer's user has no use for. Device's thread only.
#ifndef CANDIL_WORKER_DEVICES_H
#define CANDIL_WORKER_DEVICES_H

#include "server/base/error.h"

struct device; // vk/device.h
struct gl_device; // gl/device.h

struct devices {
	struct device *vk; // NULL: there is none, and nothing renders
	struct gl_device *gl; // NULL: not opened yet
};

// The OpenGL device, opened if it was not. STATUS_DEVICE if there is none.
enum status devices_gl(struct devices *devices, struct gl_device **gl, struct error *err);

// Close both, with the programs and pipelines that they keep. Nothing else that is theirs may be left.
void devices_finish(struct devices *devices);

#endif
