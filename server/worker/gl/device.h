// An OpenGL 4.5 core context without a window, and everything that lives as long as it does. The mirror of vk/device.h, for
// the techniques that rasterise and sample volumes. Only for the thread that made it, the device's: the context is current
// there.
#ifndef CANDIL_WORKER_GL_DEVICE_H
#define CANDIL_WORKER_GL_DEVICE_H

#include <stdbool.h>
#include <stdint.h>

#include "server/base/error.h"

#define GL_DEVICE_NAME_BYTES 128u
#define GL_UUID_BYTES 16u

struct gl_program;
struct code_list; // worker/code_list.h

// Which GPU to open, and whose memory budget to share. What it points to outlives the device.
struct gl_device_options {
	const uint8_t *uuid; // GL_UUID_BYTES of the GPU to match, as Vulkan tells it; NULL: any
	bool software; // the device to match is a software one
	uint64_t *bytes; // what the worker has allocated on its devices; counted up and down here too
	const uint64_t *budget; // what it may allocate
	uint64_t *wanted; // set to the bytes of an allocation that the budget refuses; NULL: nobody asks
};

// An open device. Fields are for reading, but those that a module named beside them keeps.
struct gl_device {
	void *display; // EGLDisplay
	void *context; // EGLContext
	char name[GL_DEVICE_NAME_BYTES]; // renderer and version
	bool same_device; // it has the UUID that was asked for
	uint64_t *bytes; // the options'
	const uint64_t *budget;
	uint64_t *wanted;
	uint64_t storage_bytes_max; // of one storage block
	uint32_t volume_side_max; // texels of a 3D texture's side
	uint32_t image_side_max; // of a 2D texture's
	uint64_t errors; // messages of the debug output about errors or undefined behaviour, since the start
	bool lost; // the context was reset: only a new process can open the device again
	unsigned vertex_array; // an empty one: shaders read vertices from storage buffers
	struct gl_program *programs; // kept by program.c
	uint64_t program_turn; // counts gl_program_get
	bool software; // its driver compiles programs anew for other shapes of textures
	uint64_t shapes; // of what is bound since gl_program_use: kept by texture.c and scene.c by gl_shape
	struct code_list *code; // asked before a program is made or runs in a new way; NULL: nobody is asked
	struct gl_program *settle; // kept by settle.c
	unsigned settle_texture;
};

// Open a context on the GPU that `options` name where EGL tells UUIDs, else on the first one of the kind asked for. *device
// is the caller's. CANDIL_VALIDATION=1 in the environment asks for a debug context, whose messages are counted and logged.
// STATUS_DEVICE, with what is missing in the sentence; STATUS_MEMORY.
enum status gl_device_create(const struct gl_device_options *options, struct gl_device **device, struct error *err);

// Close and free it. Its buffers, textures and programs must be gone: devices_finish destroys the programs. NULL is allowed.
void gl_device_destroy(struct gl_device *device);

// What went wrong on the device since the last call, with `what` as the subject of the sentence ("making a buffer"):
// STATUS_MEMORY, or STATUS_DEVICE, with `lost` set if the context was reset. STATUS_OK: nothing.
enum status gl_check(struct gl_device *device, const char *what, struct error *err);

// Wait until all work so far is done, then gl_check.
enum status gl_wait(struct gl_device *device, const char *what, struct error *err);

// Check that `bytes` more fit the budget; STATUS_MEMORY if not, with *wanted set to them. Allocates and counts nothing.
enum status gl_reserve(const struct gl_device *device, uint64_t bytes, struct error *err);

#endif
