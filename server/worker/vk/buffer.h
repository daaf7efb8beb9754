// Buffers on a Vulkan device: one allocation each, counted against the device's memory budget. Device's thread only. A
// buffer is its holder's, who finishes it before the device goes. Sizes and offsets are bytes. Beside the failures named
// below, STATUS_DEVICE means that the device failed.
#ifndef CANDIL_WORKER_VK_BUFFER_H
#define CANDIL_WORKER_VK_BUFFER_H

#include "server/worker/vk/device.h"

// A buffer; zeroed: none. May be moved by copying the struct.
struct buffer {
	VkBuffer handle;
	VkDeviceMemory memory;
	uint64_t bytes; // asked for
	uint64_t made; // that it has: at least as many
	uint64_t allocated; // taken from the budget
	void *map; // host address, or NULL where the host cannot see it
};

// Whose memory a buffer is in.
enum buffer_home {
	BUFFER_DEVICE, // the device's own; the host may see it or not
	BUFFER_READBACK, // the host's, for reading
	BUFFER_STAGING, // the host's, for writing
};

// Make a storage buffer of `bytes` (> 0), its content undefined. STATUS_MEMORY if the budget or the device is exhausted or
// the device cannot bind so large a buffer. On failure *buffer is zeroed.
enum status buffer_init(struct buffer *buffer, struct device *device, uint64_t bytes, enum buffer_home home,
			struct error *err);

// Free a buffer that the device no longer uses, and zero it. A zeroed one is fine.
void buffer_finish(struct buffer *buffer, struct device *device);

// Make a buffer in device memory with a copy of `data`, through a staging buffer where the host cannot write it. Blocks.
// 0 bytes: a zeroed buffer. STATUS_MEMORY as buffer_init; on failure *buffer is zeroed.
enum status buffer_init_with(struct buffer *buffer, struct device *device, const void *data, uint64_t bytes,
			     struct error *err);

// Set all bytes to zero. Blocks; no recording may be open (command.h).
enum status buffer_clear(struct buffer *buffer, struct device *device, struct error *err);

// Copy `data` to bytes [offset, offset + bytes). Blocks; no recording may be open. STATUS_MEMORY if there is no room for a
// staging buffer of `bytes` where the host cannot see this one.
enum status buffer_write(struct buffer *buffer, struct device *device, uint64_t offset, uint64_t bytes, const void *data,
			 struct error *err);

// Copy bytes [offset, offset + bytes) to `out`. Blocks; no recording may be open. STATUS_MEMORY if there is no room for a
// readback buffer of `bytes` where the host cannot see this one.
enum status buffer_read(const struct buffer *buffer, struct device *device, uint64_t offset, uint64_t bytes, void *out,
			struct error *err);

#endif
