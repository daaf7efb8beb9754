#include "server/worker/vk/device.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/sysinfo.h>

#include "server/base/log.h"
#include "server/base/room.h"
#include "server/base/room_need.h"
#include "shaders/shared/bindings.h"

// Storage buffers of the pass that has most. Its texel buffers do not count.
#define STORAGE_BUFFERS_NEEDED (BIND_MOST - BIND_TEXELS_MOST)

enum status device_error(VkResult result, const char *what, struct error *err)
{
	bool memory = result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY;
	error_set(err, memory ? STATUS_MEMORY : STATUS_DEVICE, "%s failed on the device (VkResult %d)", what, (int)result);
	if (result == VK_ERROR_OUT_OF_HOST_MEMORY && err)
		room_advise(err->text, sizeof err->text);
	return memory ? STATUS_MEMORY : STATUS_DEVICE;
}

static VKAPI_ATTR VkBool32 VKAPI_CALL on_validation(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
						    VkDebugUtilsMessageTypeFlagsEXT types,
						    const VkDebugUtilsMessengerCallbackDataEXT *data, void *user)
{
	(void)types;
	struct device *d = user;
	if (severity >= VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT)
		atomic_fetch_add(&d->validation_errors, 1);
	log_line(LOG_ERROR, "validation: %s", data->pMessage);
	return VK_FALSE;
}

static bool validation_wanted(void)
{
	const char *v = getenv("CANDIL_VALIDATION");
	return v && !strcmp(v, "1");
}

static enum status instance_create(VkInstance *instance, struct error *err)
{
	static const char *const layers[] = {"VK_LAYER_KHRONOS_validation"};
	static const char *const extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME};
	const bool validate = validation_wanted();
	if (room_need(ROOM_DRIVERS_BYTES, "the drivers of Vulkan", err) != STATUS_OK)
		return STATUS_MEMORY;
	const VkApplicationInfo app = {
	    .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .pApplicationName = "candil", .apiVersion = VK_API_VERSION_1_2};
	const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
					   .pApplicationInfo = &app,
					   .enabledLayerCount = validate ? 1 : 0,
					   .ppEnabledLayerNames = layers,
					   .enabledExtensionCount = validate ? 1 : 0,
					   .ppEnabledExtensionNames = extensions};
	VkResult r = vkCreateInstance(&info, NULL, instance);
	if (r == VK_ERROR_LAYER_NOT_PRESENT)
		return error_set(
		    err, STATUS_DEVICE,
		    "CANDIL_VALIDATION is set but the validation layer is missing: install vulkan-validationlayers");
	if (r == VK_ERROR_INCOMPATIBLE_DRIVER)
		return error_set(err, STATUS_DEVICE, "no Vulkan driver: install mesa-vulkan-drivers or the GPU's own");
	if (r != VK_SUCCESS)
		return device_error(r, "creating the Vulkan instance", err);
	return STATUS_OK;
}

static const char *type_name(VkPhysicalDeviceType type)
{
	switch (type) {
	case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
		return "discrete";
	case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
		return "integrated";
	case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
		return "virtual";
	case VK_PHYSICAL_DEVICE_TYPE_CPU:
		return "cpu";
	default:
		return "other";
	}
}

static bool compute_family(VkPhysicalDevice physical, uint32_t *family)
{
	VkQueueFamilyProperties families[16];
	uint32_t count = 16;
	vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families);
	for (uint32_t i = 0; i < count; i++)
		if (families[i].queueCount > 0 && families[i].queueFlags & VK_QUEUE_COMPUTE_BIT) {
			*family = i;
			return true;
		}
	return false;
}

static const VkSubgroupFeatureFlags needed_subgroup =
    VK_SUBGROUP_FEATURE_BASIC_BIT | VK_SUBGROUP_FEATURE_VOTE_BIT | VK_SUBGROUP_FEATURE_SHUFFLE_BIT;

static void check_usable(VkPhysicalDevice physical, const VkPhysicalDeviceProperties *p, struct device_info *info)
{
	uint32_t family;
	info->usable = false;
	if (p->apiVersion < VK_API_VERSION_1_2)
		snprintf(info->why_not, sizeof info->why_not, "Vulkan 1.2 is needed, its driver has %u.%u",
			 VK_API_VERSION_MAJOR(p->apiVersion), VK_API_VERSION_MINOR(p->apiVersion));
	else if (!compute_family(physical, &family))
		snprintf(info->why_not, sizeof info->why_not, "it has no compute queue");
	else if (p->limits.maxPerStageDescriptorStorageBuffers < STORAGE_BUFFERS_NEEDED)
		snprintf(info->why_not, sizeof info->why_not, "%d storage buffers a stage are needed, it has %u",
			 STORAGE_BUFFERS_NEEDED, p->limits.maxPerStageDescriptorStorageBuffers);
	else if ((info->subgroup_operations & needed_subgroup) != needed_subgroup)
		snprintf(info->why_not, sizeof info->why_not, "its subgroups cannot vote and shuffle in compute shaders");
	else
		info->usable = true;
}

static void describe(VkPhysicalDevice physical, uint32_t index, struct device_info *info)
{
	VkPhysicalDeviceDriverProperties driver = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
	VkPhysicalDeviceIDProperties id = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES, .pNext = &driver};
	VkPhysicalDeviceSubgroupProperties subgroup = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES,
						       .pNext = &id};
	VkPhysicalDeviceProperties2 p = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &subgroup};
	VkPhysicalDeviceMemoryProperties memory;
	memset(info, 0, sizeof *info);
	info->index = index;
	// A Vulkan 1.0 driver has no vkGetPhysicalDeviceProperties2; the plain call tells the version first.
	vkGetPhysicalDeviceProperties(physical, &p.properties);
	if (p.properties.apiVersion >= VK_API_VERSION_1_2)
		vkGetPhysicalDeviceProperties2(physical, &p);
	snprintf(info->name, sizeof info->name, "%.64s%s%.56s", p.properties.deviceName, driver.driverInfo[0] ? ", " : "",
		 driver.driverInfo);
	memcpy(info->uuid_bytes, id.deviceUUID, sizeof info->uuid_bytes);
	for (unsigned i = 0, o = 0; i < VK_UUID_SIZE; i++) {
		if (i == 4 || i == 6 || i == 8 || i == 10)
			info->uuid[o++] = '-';
		snprintf(info->uuid + o, 3, "%02x", id.deviceUUID[i]);
		o += 2;
	}
	snprintf(info->key, sizeof info->key, "%u:%s", index, info->uuid);
	info->type = type_name(p.properties.deviceType);
	info->api = p.properties.apiVersion;
	info->software = p.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
	if (info->software)
		(void)room_need_device(&info->room);
	vkGetPhysicalDeviceMemoryProperties(physical, &memory);
	for (uint32_t i = 0; i < memory.memoryHeapCount; i++)
		if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT &&
		    memory.memoryHeaps[i].size > info->memory_bytes)
			info->memory_bytes = memory.memoryHeaps[i].size;
	info->subgroup = subgroup.subgroupSize;
	if (subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT)
		info->subgroup_operations = subgroup.supportedOperations;
	info->packets = info->subgroup == 4 || info->subgroup == 8 || info->subgroup == 16;
	check_usable(physical, &p.properties, info);
}

static enum status list_physical(VkInstance instance, VkPhysicalDevice physical[DEVICE_MAX], struct device_info *infos,
				 uint32_t *count, struct error *err)
{
	*count = DEVICE_MAX;
	VkResult r = vkEnumeratePhysicalDevices(instance, count, physical);
	if (r != VK_SUCCESS && r != VK_INCOMPLETE)
		return device_error(r, "listing the devices", err);
	for (uint32_t i = 0; i < *count; i++)
		describe(physical[i], i, &infos[i]);
	return STATUS_OK;
}

enum status device_list(struct device_info infos[DEVICE_MAX], uint32_t *count, struct error *err)
{
	VkInstance instance;
	VkPhysicalDevice physical[DEVICE_MAX];
	*count = 0;
	enum status s = instance_create(&instance, err);
	if (s != STATUS_OK)
		return s;
	s = list_physical(instance, physical, infos, count, err);
	vkDestroyInstance(instance, NULL);
	return s;
}

static int preference(const struct device_info *info)
{
	static const char *const order[] = {"cpu", "other", "virtual", "integrated", "discrete"};
	for (int i = 0; i < 5; i++)
		if (!strcmp(info->type, order[i]))
			return i;
	return -1;
}

static bool is_wanted(const struct device_info *info, const char *wanted)
{
	if (!strcmp(wanted, "cpu"))
		return info->software;
	char *end;
	unsigned long index = strtoul(wanted, &end, 10);
	if (*end == 0)
		return index == info->index;
	return !strcasecmp(wanted, info->uuid);
}

static bool is_avoided(const struct device_info *info, const struct device_options *options)
{
	for (uint32_t i = 0; i < options->avoid_count; i++)
		if (!strcmp(info->key, options->avoid[i]))
			return true;
	return false;
}

enum status device_choose(const struct device_info *infos, uint32_t count, const struct device_options *options,
			  uint32_t *chosen, uint32_t *others, char *why, struct error *err)
{
	const bool any = !options->wanted || !*options->wanted;
	int best = -1;
	bool best_avoided = false;
	*others = 0;
	const struct device_info *refused = NULL;
	for (uint32_t i = 0; i < count; i++) {
		if (!any && !is_wanted(&infos[i], options->wanted))
			continue;
		if (!infos[i].usable || (options->require_gpu && infos[i].software)) {
			refused = &infos[i];
			continue;
		}
		const bool avoided = is_avoided(&infos[i], options);
		*others += !avoided;
		if (best < 0 || (best_avoided && !avoided) ||
		    (best_avoided == avoided && preference(&infos[i]) > preference(&infos[best]))) {
			best = (int)i;
			best_avoided = avoided;
		}
	}
	if (best >= 0 && infos[best].room.code != STATUS_OK)
		return error_set(err, infos[best].room.code, "%s", infos[best].room.text);
	if (best >= 0) {
		*others -= !best_avoided;
		*chosen = (uint32_t)best;
		snprintf(why, LIMIT_TEXT + 1, any ? "the best of %u (%s)" : "asked for, of %u (%s)", count,
			 infos[best].type);
		return STATUS_OK;
	}
	if (refused && refused->usable)
		return error_set(err, STATUS_DEVICE,
				 "a GPU is required and only software devices were found: "
				 "install the GPU's Vulkan driver or leave --require-gpu out");
	if (refused)
		return error_set(err, STATUS_DEVICE, "%.100s cannot be used: %.120s", refused->name, refused->why_not);
	if (!any)
		return error_set(err, STATUS_DEVICE, "no device is '%.64s': see `candil doctor` for those there are",
				 options->wanted);
	return error_set(err, STATUS_DEVICE, "no Vulkan device: install mesa-vulkan-drivers or the GPU's own driver");
}

static enum status watch_validation(struct device *d, struct error *err)
{
	if (!validation_wanted())
		return STATUS_OK;
	PFN_vkCreateDebugUtilsMessengerEXT create =
	    (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(d->instance, "vkCreateDebugUtilsMessengerEXT");
	const VkDebugUtilsMessengerCreateInfoEXT info = {.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
							 .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
									    VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
							 .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
							 .pfnUserCallback = on_validation,
							 .pUserData = d};
	VkResult r = create ? create(d->instance, &info, NULL, &d->messenger) : VK_ERROR_EXTENSION_NOT_PRESENT;
	return r == VK_SUCCESS ? STATUS_OK : device_error(r, "watching the validation layer", err);
}

static enum status open_logical(struct device *d, struct error *err)
{
	const float priority = 1.0f;
	compute_family(d->physical, &d->queue_family);
	const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
					       .queueFamilyIndex = d->queue_family,
					       .queueCount = 1,
					       .pQueuePriorities = &priority};
	const VkDeviceCreateInfo info = {
	    .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .queueCreateInfoCount = 1, .pQueueCreateInfos = &queue};
	VkResult r = vkCreateDevice(d->physical, &info, NULL, &d->handle);
	if (r != VK_SUCCESS)
		return device_error(r, "opening the device", err);
	vkGetDeviceQueue(d->handle, d->queue_family, 0, &d->queue);

	const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
					      .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
					      .queueFamilyIndex = d->queue_family};
	r = vkCreateCommandPool(d->handle, &pool, NULL, &d->pool);
	if (r != VK_SUCCESS)
		return device_error(r, "making a command pool", err);
	const VkCommandBufferAllocateInfo commands = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
						      .commandPool = d->pool,
						      .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
						      .commandBufferCount = 1};
	r = vkAllocateCommandBuffers(d->handle, &commands, &d->commands);
	if (r != VK_SUCCESS)
		return device_error(r, "making a command buffer", err);
	const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
	r = vkCreateFence(d->handle, &fence, NULL, &d->fence);
	return r == VK_SUCCESS ? STATUS_OK : device_error(r, "making a fence", err);
}

static uint64_t default_budget(const struct device_info *info)
{
	struct sysinfo si;
	if (info->software && sysinfo(&si) == 0)
		return (uint64_t)si.totalram * si.mem_unit / 2;
	return info->memory_bytes / 5 * 4;
}

enum status device_create(const struct device_options *options, struct device **device, struct error *err)
{
	struct device_info infos[DEVICE_MAX];
	VkPhysicalDevice physical[DEVICE_MAX];
	uint32_t count, chosen, others = 0;
	char why[LIMIT_TEXT + 1];
	struct device *d = calloc(1, sizeof *d);
	if (!d)
		return error_set(err, STATUS_MEMORY, "out of memory");
	enum status s = instance_create(&d->instance, err);
	if (s == STATUS_OK)
		s = watch_validation(d, err);
	if (s == STATUS_OK)
		s = list_physical(d->instance, physical, infos, &count, err);
	if (s == STATUS_OK)
		s = device_choose(infos, count, options, &chosen, &others, why, err);
	if (s != STATUS_OK)
		goto fail;
	d->others = others;
	d->physical = physical[chosen];
	d->info = infos[chosen];
	VkPhysicalDeviceProperties p;
	vkGetPhysicalDeviceProperties(d->physical, &p);
	d->limits = p.limits;
	vkGetPhysicalDeviceMemoryProperties(d->physical, &d->memory);
	d->budget = options->memory_budget ? options->memory_budget : default_budget(&d->info);
	s = open_logical(d, err);
	if (s != STATUS_OK)
		goto fail;
	log_line(LOG_INFO, "device %u: %s: %s", d->info.index, d->info.name, why);
	*device = d;
	return STATUS_OK;
fail:
	device_destroy(d);
	return s;
}

void device_destroy(struct device *d)
{
	if (!d)
		return;
	if (d->handle) {
		vkDeviceWaitIdle(d->handle);
		vkDestroyFence(d->handle, d->fence, NULL);
		vkDestroyCommandPool(d->handle, d->pool, NULL);
		vkDestroyDevice(d->handle, NULL);
	}
	if (d->messenger) {
		PFN_vkDestroyDebugUtilsMessengerEXT destroy = (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
		    d->instance, "vkDestroyDebugUtilsMessengerEXT");
		destroy(d->instance, d->messenger, NULL);
	}
	if (d->instance)
		vkDestroyInstance(d->instance, NULL);
	free(d);
}
