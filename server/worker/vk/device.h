// A Vulkan device and everything that lives as long as it does. Device's thread only, but any thread may read
// `validation_errors`.
#ifndef CANDIL_WORKER_VK_DEVICE_H
#define CANDIL_WORKER_VK_DEVICE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <vulkan/vulkan.h>

#include "server/base/error.h"

#define DEVICE_MAX 16u // devices that are listed at most
#define DEVICE_NAME_BYTES 128u

struct pipeline;
struct code_list; // worker/code_list.h

// What the driver tells of one physical device.
struct device_info {
	uint32_t index; // among those listed
	char name[DEVICE_NAME_BYTES]; // with the driver: "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe Mesa 22.3.6 …"
	char uuid[37];
	char key[48]; // index and UUID: a device is the same to a later process if both are
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
	struct error room; // STATUS_MEMORY: a limit of address space leaves too little for it
};

// Which device the user wants. Zeroed: the best, with the default budget.
struct device_options {
	const char *wanted; // NULL: the best; an index, a UUID or "cpu"
	bool require_gpu; // refuse software devices
	const char *avoid[DEVICE_MAX]; // keys of devices that are taken only if there is no other
	uint32_t avoid_count;
	uint64_t memory_budget; // bytes; 0: half of the memory if software, else four fifths of the device's
};

// An open device: one queue, one command buffer, one budget.
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
	uint64_t bytes; // allocated now, here and on the OpenGL device
	uint64_t budget; // bytes that may be allocated
	uint32_t others; // usable devices that the options allow, beside this one and those to be avoided
	uint64_t wanted; // bytes of the last allocation that the budget refused, here or on the OpenGL device
	bool lost; // the driver says so: only a new process can open it again
	struct pipeline *pipelines; // kept by pipeline.c
	uint64_t pipeline_turn; // counts pipeline_get
	struct code_list *code; // asked before a pipeline is made; NULL: nobody is asked
};

// List the physical devices, usable or not. *count is at most DEVICE_MAX. STATUS_DEVICE if there is no Vulkan loader or no
// driver.
enum status device_list(struct device_info infos[DEVICE_MAX], uint32_t *count, struct error *err);

// Choose a device: *chosen is its place in `infos`, `why` (LIMIT_TEXT + 1 bytes) the reason in words, *others as in struct
// device. STATUS_DEVICE if none of them is what the options ask for and usable; STATUS_MEMORY if there is no room for the
// one.
enum status device_choose(const struct device_info *infos, uint32_t count, const struct device_options *options,
			  uint32_t *chosen, uint32_t *others, char *why, struct error *err);

// Open the device that the options choose; *device is the caller's. With CANDIL_VALIDATION=1 in the environment the Khronos
// validation layer checks every call, and opening fails where the layer is missing. STATUS_DEVICE, STATUS_MEMORY.
enum status device_create(const struct device_options *options, struct device **device, struct error *err);

// Close and free it. Its buffers and pipelines must be gone: devices_finish destroys the pipelines. NULL is allowed.
void device_destroy(struct device *device);

// Put a failed VkResult in words: `what` is the subject of the sentence ("making a fence"). Returns STATUS_MEMORY for
// VK_ERROR_OUT_OF_*_MEMORY, STATUS_DEVICE for all others.
enum status device_error(VkResult result, const char *what, struct error *err);

#endif
