#include "server/worker/vk/buffer.h"

#include <string.h>

#include "server/worker/vk/command.h"

static const VkMemoryPropertyFlags host_flags = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;

// The flags to look for, best first. A device whose own memory the host sees anyway (software, integrated) saves a copy.
static int memory_type(const struct device *d, uint32_t allowed, enum buffer_home home)
{
	const VkMemoryPropertyFlags device = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
	const VkMemoryPropertyFlags cached = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
	const VkMemoryPropertyFlags wishes[3][2] = {
	    [BUFFER_DEVICE] = {d->info.software ? device | host_flags : device, device},
	    [BUFFER_READBACK] = {host_flags | cached, host_flags},
	    [BUFFER_STAGING] = {host_flags, host_flags},
	};
	for (int w = 0; w < 2; w++)
		for (uint32_t i = 0; i < d->memory.memoryTypeCount; i++)
			if (allowed & 1u << i &&
			    (d->memory.memoryTypes[i].propertyFlags & wishes[home][w]) == wishes[home][w])
				return (int)i;
	return -1;
}

static enum status allocate(struct buffer *b, struct device *d, enum buffer_home home, struct error *err)
{
	VkMemoryRequirements need;
	vkGetBufferMemoryRequirements(d->handle, b->handle, &need);
	int type = memory_type(d, need.memoryTypeBits, home);
	if (type < 0)
		return error_set(err, STATUS_DEVICE, "the device has no memory for a buffer of this kind");
	const bool fits = need.size <= d->budget && d->bytes <= d->budget - need.size;
	if (!fits) {
		d->wanted = need.size;
		return error_set(err, STATUS_MEMORY,
				 "%llu MiB more would exceed the memory budget of %llu MiB (%llu in use): render smaller, "
				 "unload scenes or raise --memory-budget",
				 (unsigned long long)(need.size >> 20), (unsigned long long)(d->budget >> 20),
				 (unsigned long long)(d->bytes >> 20));
	}
	const VkMemoryAllocateInfo info = {
	    .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = need.size, .memoryTypeIndex = (uint32_t)type};
	VkResult r = vkAllocateMemory(d->handle, &info, NULL, &b->memory);
	if (r != VK_SUCCESS)
		return device_error(r, "allocating memory", err);
	b->allocated = need.size;
	d->bytes += need.size;
	r = vkBindBufferMemory(d->handle, b->handle, b->memory, 0);
	if (r == VK_SUCCESS && (d->memory.memoryTypes[type].propertyFlags & host_flags) == host_flags)
		r = vkMapMemory(d->handle, b->memory, 0, VK_WHOLE_SIZE, 0, &b->map);
	return r == VK_SUCCESS ? STATUS_OK : device_error(r, "binding memory", err);
}

// llvmpipe compiles a shader once more for texel buffers (pipeline.h) whose size is a power of two or has a second byte of
// 0, which it takes for the levels of a texture. No buffer is such, so that the code for one scene is that for all.
static uint64_t made_for_one_code(const struct device *d, uint64_t bytes)
{
	uint64_t made = bytes;
	while ((made & (made - 1)) == 0 || (made >> 8 & 0xff) == 0)
		made += 64;
	return made <= d->limits.maxStorageBufferRange ? made : bytes;
}

enum status buffer_init(struct buffer *b, struct device *d, uint64_t bytes, enum buffer_home home, struct error *err)
{
	memset(b, 0, sizeof *b);
	if (home == BUFFER_DEVICE && bytes > d->limits.maxStorageBufferRange)
		return error_set(err, STATUS_MEMORY, "a buffer of %llu MiB is more than this device can bind (%u MiB)",
				 (unsigned long long)(bytes >> 20), d->limits.maxStorageBufferRange >> 20);
	const uint64_t made = home == BUFFER_DEVICE ? made_for_one_code(d, bytes) : bytes;
	const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
					 .size = made,
					 .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
						  VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
						  VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT};
	VkResult r = vkCreateBuffer(d->handle, &info, NULL, &b->handle);
	if (r != VK_SUCCESS)
		return device_error(r, "creating a buffer", err);
	b->bytes = bytes;
	b->made = made;
	enum status s = allocate(b, d, home, err);
	if (s != STATUS_OK)
		buffer_finish(b, d);
	return s;
}

void buffer_finish(struct buffer *b, struct device *d)
{
	// Never made: there may not even be a device.
	if (!b->handle)
		return;
	vkDestroyBuffer(d->handle, b->handle, NULL);
	if (b->memory)
		vkFreeMemory(d->handle, b->memory, NULL);
	d->bytes -= b->allocated;
	memset(b, 0, sizeof *b);
}

// Copy between a device buffer and a host-visible one, and wait.
static enum status copy(struct device *d, VkBuffer from, uint64_t from_offset, VkBuffer to, uint64_t to_offset,
			uint64_t bytes, struct error *err)
{
	enum status s = command_begin(d, err);
	if (s != STATUS_OK)
		return s;
	const VkBufferCopy region = {.srcOffset = from_offset, .dstOffset = to_offset, .size = bytes};
	vkCmdCopyBuffer(d->commands, from, to, 1, &region);
	command_barrier(d);
	return command_finish(d, err);
}

enum status buffer_init_with(struct buffer *b, struct device *d, const void *data, uint64_t bytes, struct error *err)
{
	memset(b, 0, sizeof *b);
	if (bytes == 0)
		return STATUS_OK;
	enum status s = buffer_init(b, d, bytes, BUFFER_DEVICE, err);
	if (s != STATUS_OK)
		return s;
	if (b->map) {
		memcpy(b->map, data, bytes);
		return STATUS_OK;
	}
	struct buffer staging;
	s = buffer_init(&staging, d, bytes, BUFFER_STAGING, err);
	if (s == STATUS_OK) {
		memcpy(staging.map, data, bytes);
		s = copy(d, staging.handle, 0, b->handle, 0, bytes, err);
		buffer_finish(&staging, d);
	}
	if (s != STATUS_OK)
		buffer_finish(b, d);
	return s;
}

enum status buffer_write(struct buffer *b, struct device *d, uint64_t offset, uint64_t bytes, const void *data,
			 struct error *err)
{
	if (b->map) {
		memcpy((char *)b->map + offset, data, bytes);
		return STATUS_OK;
	}
	struct buffer staging;
	enum status s = buffer_init(&staging, d, bytes, BUFFER_STAGING, err);
	if (s != STATUS_OK)
		return s;
	memcpy(staging.map, data, bytes);
	s = copy(d, staging.handle, 0, b->handle, offset, bytes, err);
	buffer_finish(&staging, d);
	return s;
}

enum status buffer_clear(struct buffer *b, struct device *d, struct error *err)
{
	if (b->map) {
		memset(b->map, 0, b->bytes);
		return STATUS_OK;
	}
	enum status s = command_begin(d, err);
	if (s != STATUS_OK)
		return s;
	vkCmdFillBuffer(d->commands, b->handle, 0, VK_WHOLE_SIZE, 0);
	command_barrier(d);
	return command_finish(d, err);
}

enum status buffer_read(const struct buffer *b, struct device *d, uint64_t offset, uint64_t bytes, void *out,
			struct error *err)
{
	if (b->map) {
		memcpy(out, (const char *)b->map + offset, bytes);
		return STATUS_OK;
	}
	struct buffer back;
	enum status s = buffer_init(&back, d, bytes, BUFFER_READBACK, err);
	if (s != STATUS_OK)
		return s;
	s = copy(d, b->handle, offset, back.handle, 0, bytes, err);
	if (s == STATUS_OK)
		memcpy(out, back.map, bytes);
	buffer_finish(&back, d);
	return s;
}
