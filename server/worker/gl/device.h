// An OpenGL 4.5 core context without a window, and everything that lives as long as it does. The mirror of vk/device.h, for
// the techniques that rasterise and sample volumes. Used by the thread that made it, alone: the context is current there.
#ifndef CANDIL_WORKER_GL_DEVICE_H
#define CANDIL_WORKER_GL_DEVICE_H

#include <stdbool.h>
#include <stdint.h>

#include "server/base/error.h"

#define GL_DEVICE_NAME_BYTES 128u
#define GL_UUID_BYTES 16u

struct gl_program;

struct gl_device_options {
	const uint8_t *uuid; // GL_UUID_BYTES of the GPU to match, as Vulkan tells it; NULL: any
	bool software; // the device to match is a software one
	uint64_t *bytes; // what the worker holds on its devices; counted up and down here too
	const uint64_t *budget; // and may
	uint64_t *wanted; // set to what is refused for the budget's sake; NULL: nobody asks
};

struct gl_device {
	void *display; // EGLDisplay
	void *context; // EGLContext
	char name[GL_DEVICE_NAME_BYTES]; // renderer and version
	bool same_device; // it told the UUID asked for
	uint64_t *bytes;
	const uint64_t *budget;
	uint64_t *wanted;
	uint64_t storage_bytes_max; // of one storage block
	uint32_t volume_side_max; // texels of a 3D texture's side
	uint32_t image_side_max; // of a 2D texture's
	uint64_t errors; // messages of the debug output that say error or undefined behaviour, since the start
	bool lost; // the context was reset: only a new process has a device again
	unsigned vertex_array; // an empty one: vertices are pulled out of storage buffers
	struct gl_program *programs; // by program.c
	uint64_t program_turn; // counts gl_program_get
};

// Open a context on the same GPU as `options` name where EGL can tell, else on the default one of the kind asked for.
// STATUS_DEVICE with what is missing. CANDIL_VALIDATION=1 asks for a debug context, whose messages are counted and logged.
enum status gl_device_create(const struct gl_device_options *options, struct gl_device **device, struct error *err);

// NULL is allowed. Its programs must be gone: devices_finish sees to that.
void gl_device_destroy(struct gl_device *device);

// What went wrong since the last call, if anything: STATUS_MEMORY, or STATUS_DEVICE with `what` in the sentence.
enum status gl_check(struct gl_device *device, const char *what, struct error *err);

// Wait until all work so far is done, then gl_check.
enum status gl_wait(struct gl_device *device, const char *what, struct error *err);

// Whether `bytes` more fit the budget; STATUS_MEMORY with a sentence if not. Counts nothing.
enum status gl_reserve(const struct gl_device *device, uint64_t bytes, struct error *err);

#endif
