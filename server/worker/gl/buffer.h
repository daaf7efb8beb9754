// Storage buffers on the OpenGL device, counted against the memory budget. The mirror of vk/buffer.h. Device's thread only.
// A buffer is its holder's, who finishes it before the device goes. Sizes and offsets are bytes.
#ifndef CANDIL_WORKER_GL_BUFFER_H
#define CANDIL_WORKER_GL_BUFFER_H

#include "server/worker/gl/device.h"

// A buffer; zeroed: none. May be moved by copying the struct.
struct gl_buffer {
	unsigned name; // 0: none
	uint64_t bytes;
};

// Make a buffer of `bytes` (> 0) with a copy of `data`; NULL: zeros. STATUS_MEMORY if the budget, the device or its largest
// binding is too small; STATUS_DEVICE. On failure *buffer is zeroed.
enum status gl_buffer_init(struct gl_buffer *buffer, struct gl_device *device, uint64_t bytes, const void *data,
			   struct error *err);

// Free the buffer and zero it; commands under way may still use it. A zeroed one is fine.
void gl_buffer_finish(struct gl_buffer *buffer, struct gl_device *device);

// Set all bytes to zero, in the order of the commands.
void gl_buffer_clear(const struct gl_buffer *buffer);

// Replace bytes [offset, offset + bytes), in the order of the commands.
void gl_buffer_write(const struct gl_buffer *buffer, uint64_t offset, uint64_t bytes, const void *data);

// Copy bytes [offset, offset + bytes) to `out`, after all shaders' writes so far. Blocks. Fails as gl_check does.
enum status gl_buffer_read(const struct gl_buffer *buffer, struct gl_device *device, uint64_t offset, uint64_t bytes,
			   void *out, struct error *err);

// Bind to storage block `binding`, for the programs that run from now on.
void gl_buffer_bind(const struct gl_buffer *buffer, unsigned binding);

#endif
