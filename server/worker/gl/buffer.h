// Storage buffers on the OpenGL device, counted against the memory budget. The mirror of vk/buffer.h.
#ifndef CANDIL_WORKER_GL_BUFFER_H
#define CANDIL_WORKER_GL_BUFFER_H

#include "server/worker/gl/device.h"

struct gl_buffer {
	unsigned name; // 0: none
	uint64_t bytes;
};

// A buffer of `bytes` (> 0) with this content; NULL: zeros. STATUS_MEMORY if the budget, the device or its largest binding
// is too small; nothing is left behind then.
enum status gl_buffer_init(struct gl_buffer *buffer, struct gl_device *device, uint64_t bytes, const void *data,
			   struct error *err);
void gl_buffer_finish(struct gl_buffer *buffer, struct gl_device *device); // a zeroed one is fine

// Set all bytes to zero, in the order of the commands.
void gl_buffer_clear(const struct gl_buffer *buffer);

// Replace bytes [offset, offset + bytes), in the order of the commands.
void gl_buffer_write(const struct gl_buffer *buffer, uint64_t offset, uint64_t bytes, const void *data);

// Copy bytes [offset, offset + bytes) to the host, after all shaders' writes so far. Blocks.
enum status gl_buffer_read(const struct gl_buffer *buffer, struct gl_device *device, uint64_t offset, uint64_t bytes,
			   void *out, struct error *err);

// Bind to storage block `binding` of the programs that come.
void gl_buffer_bind(const struct gl_buffer *buffer, unsigned binding);

#endif
