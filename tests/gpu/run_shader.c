#include "tests/gpu/run_shader.h"

#include "server/worker/devices.h"

#include <string.h>

enum status shader_run_init(struct shader_run *run, const struct shader *shader, const void *in, uint64_t in_bytes,
			    uint64_t out_bytes, struct error *err)
{
	const struct device_options options = {0};
	memset(run, 0, sizeof *run);
	enum status s = device_create(&options, &run->device, err);
	if (s == STATUS_OK)
		s = pipeline_get(run->device, shader, NULL, &run->pipeline, err);
	if (s == STATUS_OK)
		s = buffer_init_with(&run->in, run->device, in, in_bytes, err);
	if (s == STATUS_OK)
		s = buffer_init(&run->out, run->device, out_bytes, BUFFER_DEVICE, err);
	if (s == STATUS_OK)
		s = buffer_clear(&run->out, run->device, err);
	const struct buffer *buffers[] = {&run->in, &run->out};
	if (s == STATUS_OK)
		s = binding_set_init(&run->bindings, run->device, run->pipeline, buffers, &run->out, err);
	if (s != STATUS_OK)
		shader_run_finish(run);
	return s;
}

enum status shader_run_dispatch(struct shader_run *run, const void *push, uint32_t push_bytes, uint32_t groups,
				struct error *err)
{
	struct device *d = run->device;
	enum status s = command_begin(d, err);
	if (s != STATUS_OK)
		return s;
	vkCmdBindPipeline(d->commands, VK_PIPELINE_BIND_POINT_COMPUTE, run->pipeline->handle);
	vkCmdBindDescriptorSets(d->commands, VK_PIPELINE_BIND_POINT_COMPUTE, run->pipeline->layout, 0, 1, &run->bindings.set,
				0, NULL);
	vkCmdPushConstants(d->commands, run->pipeline->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes, push);
	vkCmdDispatch(d->commands, groups, 1, 1);
	command_barrier(d);
	return command_finish(d, err);
}

void shader_run_finish(struct shader_run *run)
{
	if (!run->device)
		return;
	binding_set_finish(&run->bindings, run->device);
	buffer_finish(&run->in, run->device);
	buffer_finish(&run->out, run->device);
	devices_finish(&(struct devices){.vk = run->device});
	run->device = NULL;
}
