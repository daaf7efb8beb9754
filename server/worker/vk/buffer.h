// Buffers on a Vulkan device: one allocation each, counted against the device's memory budget.
#ifndef CANDIL_WORKER_VK_BUFFER_H
#define CANDIL_WORKER_VK_BUFFER_H

#include "server/worker/vk/device.h"

struct buffer {
	VkBuffer handle;
	VkDeviceMemory memory;
	uint64_t bytes; // asked for
	uint64_t allocated; // taken from the budget
	void *map; // host address, or NULL where the host cannot see it
};

enum buffer_home {
	BUFFER_DEVICE, // the device's own memory; the host may see it or not
	BUFFER_READBACK, // the host's, for reading
	BUFFER_STAGING, // the host's, for writing
};

// A storage buffer of `bytes` (> 0), its content undefined. STATUS_MEMORY if the budget or the device is exhausted or the
// device cannot bind so large a buffer; nothing is left behind then.
enum status buffer_init(struct buffer *buffer, struct device *device, uint64_t bytes, enum buffer_home home,
			struct error *err);
void buffer_finish(struct buffer *buffer, struct device *device); // a zeroed one is fine

// A device buffer with this content; through staging where the host cannot write it. 0 bytes leave a zeroed buffer.
enum status buffer_init_with(struct buffer *buffer, struct device *device, const void *data, uint64_t bytes,
			     struct error *err);

// Set all bytes to zero. Blocks.
enum status buffer_clear(struct buffer *buffer, struct device *device, struct error *err);

// Copy bytes [offset, offset + bytes) to the host. Blocks.
enum status buffer_read(const struct buffer *buffer, struct device *device, uint64_t offset, uint64_t bytes, void *out,
			struct error *err);

#endif
