#include "server/worker/vk/command.h"

enum status command_begin(struct device *d, struct error *err)
{
	const VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
					       .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
	VkResult r = vkBeginCommandBuffer(d->commands, &info);
	return r == VK_SUCCESS ? STATUS_OK : device_error(r, "recording commands", err);
}

void command_barrier(struct device *d)
{
	const VkMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
					 .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
					 .dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT |
							  VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_HOST_READ_BIT};
	const VkPipelineStageFlags stages = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
	vkCmdPipelineBarrier(d->commands, stages, stages | VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &barrier, 0, NULL, 0, NULL);
}

enum status command_finish(struct device *d, struct error *err)
{
	VkResult r = vkEndCommandBuffer(d->commands);
	if (r != VK_SUCCESS)
		return device_error(r, "recording commands", err);
	const VkSubmitInfo info = {
	    .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &d->commands};
	r = vkQueueSubmit(d->queue, 1, &info, d->fence);
	if (r == VK_SUCCESS)
		r = vkWaitForFences(d->handle, 1, &d->fence, VK_TRUE, UINT64_MAX);
	if (r == VK_SUCCESS)
		r = vkResetFences(d->handle, 1, &d->fence);
	d->lost = d->lost || r == VK_ERROR_DEVICE_LOST;
	return r == VK_SUCCESS ? STATUS_OK : device_error(r, "running commands", err);
}
