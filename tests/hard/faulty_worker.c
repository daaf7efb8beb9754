// candil-worker with a device that fails when it is told to, by a signal: a fence keeps a worker from files and from its
// environment, not from signals.
//   SIGUSR1   what is submitted next loses the device      SIGUSR2   there is no device memory for what is allocated next
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <vulkan/vulkan.h>

VkResult __real_vkQueueSubmit(VkQueue queue, uint32_t count, const VkSubmitInfo *submits, VkFence fence);
VkResult __wrap_vkQueueSubmit(VkQueue queue, uint32_t count, const VkSubmitInfo *submits, VkFence fence);
VkResult __real_vkAllocateMemory(VkDevice device, const VkMemoryAllocateInfo *info, const VkAllocationCallbacks *callbacks,
				 VkDeviceMemory *memory);
VkResult __wrap_vkAllocateMemory(VkDevice device, const VkMemoryAllocateInfo *info, const VkAllocationCallbacks *callbacks,
				 VkDeviceMemory *memory);

static atomic_bool lose, full;

static void told(int signal_number)
{
	atomic_store(signal_number == SIGUSR1 ? &lose : &full, true);
}

__attribute__((constructor)) static void listen_to_signals(void)
{
	const struct sigaction action = {.sa_handler = told, .sa_flags = SA_RESTART};
	sigaction(SIGUSR1, &action, NULL);
	sigaction(SIGUSR2, &action, NULL);
}

VkResult __wrap_vkQueueSubmit(VkQueue queue, uint32_t count, const VkSubmitInfo *submits, VkFence fence)
{
	return atomic_load(&lose) ? VK_ERROR_DEVICE_LOST : __real_vkQueueSubmit(queue, count, submits, fence);
}

VkResult __wrap_vkAllocateMemory(VkDevice device, const VkMemoryAllocateInfo *info, const VkAllocationCallbacks *callbacks,
				 VkDeviceMemory *memory)
{
	return atomic_exchange(&full, false) ? VK_ERROR_OUT_OF_DEVICE_MEMORY
					     : __real_vkAllocateMemory(device, info, callbacks, memory);
}
