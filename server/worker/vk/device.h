// A Vulkan device and everything that lives as long as it does. Used by the device's thread alone, but for
// `validation_errors`, which any thread may read.
#ifndef CANDIL_WORKER_VK_DEVICE_H
#define CANDIL_WORKER_VK_DEVICE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <vulkan/vulkan.h>

#include "server/base/error.h"

#define DEVICE_MAX 16u
#define DEVICE_NAME_BYTES 128u

struct pipeline;

// What vkEnumeratePhysicalDevices told of one device.
struct device_info {
	uint32_t index;
	char name[DEVICE_NAME_BYTES]; // with the driver: "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe Mesa 22.3.6 …"
	char uuid[37];
	uint8_t uuid_bytes[VK_UUID_SIZE];
	const char *type; // "discrete", "integrated", "virtual", "cpu", "other"
	uint32_t api; // VK_API_VERSION
	uint64_t memory_bytes; // of the largest device-local heap
	bool software;
	uint32_t subgroup; // lanes
	VkSubgroupFeatureFlags subgroup_operations; // in compute shaders
	bool packets; // a subgroup has a width that a packet can be (4, 8 or 16 lanes)
	bool usable;
	char why_not[LIMIT_TEXT + 1]; // what it lacks, when not usable
};

struct device_options {
	const char *wanted; // NULL: the best; an index, a UUID or "cpu"
	bool require_gpu; // refuse software devices
	uint64_t memory_budget; // bytes; 0: half of the memory if software, else four fifths of the device's
};

struct device {
	VkInstance instance;
	VkPhysicalDevice physical;
	VkDevice handle;
	VkQueue queue;
	uint32_t queue_family;
	struct device_info info;
	VkPhysicalDeviceLimits limits;
	VkPhysicalDeviceMemoryProperties memory;
	VkCommandPool pool;
	VkCommandBuffer commands; // recorded and waited for by command.c, one at a time
	VkFence fence;
	VkDebugUtilsMessengerEXT messenger;
	_Atomic uint64_t validation_errors;
	uint64_t bytes; // allocated now
	uint64_t budget;
	uint64_t wanted; // of what was refused last for the budget's sake, here or on the OpenGL device
	bool lost; // by the driver's word: only a new process can have it again
	struct pipeline *pipelines; // those that are kept, by pipeline.c
	uint64_t pipeline_turn;
};

// List what is there. *count is at most DEVICE_MAX. STATUS_DEVICE if there is no Vulkan loader or driver at all.
enum status device_list(struct device_info infos[DEVICE_MAX], uint32_t *count, struct error *err);

// The index in `infos` that `options` choose, with the reason in `why` (LIMIT_TEXT + 1 bytes); STATUS_DEVICE if none serves.
enum status device_choose(const struct device_info *infos, uint32_t count, const struct device_options *options,
			  uint32_t *chosen, char *why, struct error *err);

// Open the chosen device. With CANDIL_VALIDATION=1 in the environment the Khronos validation layer watches every call; a
// missing layer is then an error, not a silence.
enum status device_create(const struct device_options *options, struct device **device, struct error *err);

// NULL is allowed. Its pipelines must be gone: devices_finish sees to that.
void device_destroy(struct device *device);

// Put a VkResult in words. VK_ERROR_OUT_OF_*_MEMORY is STATUS_MEMORY, all else STATUS_DEVICE.
enum status device_error(VkResult result, const char *what, struct error *err);

#endif
