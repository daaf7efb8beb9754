#include "server/worker/technique/radiosity/patch_pass.h"

#include <stdlib.h>

#include "server/base/clock.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/trace/trace.h"
#include "server/worker/vk/command.h"

_Static_assert(BIND_PATCH_SKY_ROWS < BIND_RADIOSITY_COUNT && BIND_RADIOSITY_COUNT <= BIND_MOST,
	       "a binding set has room for the passes over patches");
_Static_assert(SPEC_PATCH_END <= SPEC_SCENE, "constants of the passes are none of the scene's");

#define FIRST_PATCHES 256u // of the first dispatch, whose time is not known
#define MOST_PATCHES 4096u // of a dispatch: those that follow may take a thousand times as long as those before

static enum status upload_faces(struct patch_pass *p, const struct patch_faces *faces, struct error *err)
{
	uint32_t(*ids)[2] = malloc((faces->count ? faces->count : 1) * sizeof *ids);
	if (!ids)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; i < faces->count; i++) {
		ids[i][0] = faces->list[i].triangle[0];
		ids[i][1] = faces->list[i].triangle[1];
	}
	const enum status s = buffer_init_with(&p->face_triangles, p->device, ids, faces->count * sizeof *ids, err);
	free(ids);
	return s;
}

enum status patch_pass_init(struct patch_pass *p, const struct patch_scene *of, uint32_t effects, bool sky_is_lamp,
			    struct error *err)
{
	struct plan plan = *of->plan;
	struct scene_params params;
	plan.effects = effects;
	plan.seed = 0; // what is made serves requests of any seed
	scene_params_fill(&plan, &of->scene->view, sky_is_lamp, &params);
	p->patches = of->elements->patches.count;
	enum status s = resident_upload(of->scene, p->device, scene_bindings_shade(&plan), err);
	if (s == STATUS_OK)
		s = buffer_init_with(&p->job, p->device, &params, sizeof params, err);
	if (s == STATUS_OK)
		s = buffer_init(&p->counters, p->device, sizeof(struct pass_counters), BUFFER_DEVICE, err);
	if (s == STATUS_OK)
		s = buffer_clear(&p->counters, p->device, err);
	return s == STATUS_OK ? upload_faces(p, &of->elements->patches.faces, err) : s;
}

enum status patch_pass_bind(struct patch_pass *p, const struct patch_scene *of, const struct shader *shader,
			    const struct constants *constants, const struct buffer *const own[3], struct error *err)
{
	const struct buffer *buffers[BIND_MOST] = {NULL};
	trace_fill_buffers(of->scene, buffers);
	element_buffers_fill(of->buffers, buffers);
	buffers[BIND_JOB] = &p->job;
	buffers[BIND_COUNTERS] = &p->counters;
	buffers[BIND_PATCH_TRIANGLES] = &p->face_triangles;
	for (uint32_t i = 0; i < 3; i++)
		buffers[BIND_PATCH_LIGHT + i] = own[i];
	enum status s = pipeline_get(p->device, shader, constants, &p->pipeline, err);
	return s == STATUS_OK ? binding_set_init(&p->set, p->device, p->pipeline, buffers, &p->job, err) : s;
}

void patch_pass_finish(struct patch_pass *p)
{
	binding_set_finish(&p->set, p->device);
	buffer_finish(&p->job, p->device);
	buffer_finish(&p->counters, p->device);
	buffer_finish(&p->face_triangles, p->device);
}

bool patch_pass_compiled(const struct patch_pass *p)
{
	return p->pipeline->warm || p->patches == 0;
}

static enum status dispatch(struct patch_pass *p, const struct patch_push *push, struct error *err)
{
	VkCommandBuffer c = p->device->commands;
	enum status s = command_begin(p->device, err);
	if (s != STATUS_OK)
		return s;
	vkCmdBindPipeline(c, VK_PIPELINE_BIND_POINT_COMPUTE, p->pipeline->handle);
	vkCmdBindDescriptorSets(c, VK_PIPELINE_BIND_POINT_COMPUTE, p->pipeline->layout, 0, 1, &p->set.set, 0, NULL);
	vkCmdPushConstants(c, p->pipeline->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof *push, push);
	vkCmdDispatch(c, push->count ? (push->count + PATCH_GROUP - 1) / PATCH_GROUP : 1, 1, 1);
	command_barrier(p->device);
	return command_finish(p->device, err);
}

enum status patch_pass_compile(struct patch_pass *p, struct error *err)
{
	if (p->pipeline->warm || p->patches == 0)
		return STATUS_OK;
	const enum status s = dispatch(p, &(struct patch_push){.light = NONE}, err);
	if (s == STATUS_OK)
		pipeline_has_run(p->device, p->pipeline);
	return s;
}

enum status patch_pass_run(struct patch_pass *p, const struct patch_push *push, struct error *err)
{
	const uint64_t start = clock_us();
	const enum status s = dispatch(p, push, err);
	const double measured = (double)(clock_us() - start) / push->count;
	p->item_us = p->item_us > 0 ? 0.5 * (p->item_us + measured) : measured;
	return s;
}

enum status patch_pass_check(const struct patch_pass *p, struct error *err)
{
	struct pass_counters counters;
	const enum status s = buffer_read(&p->counters, p->device, 0, sizeof counters, &counters, err);
	if (s == STATUS_OK && counters.cut > 0)
		return error_set(err, STATUS_TRAVERSAL_CUT,
				 "one patch's rays visit more of this scene than the driver lets a loop run: use a GPU or a "
				 "newer driver");
	return s;
}

uint32_t patch_pass_fit(const struct patch_pass *p, uint32_t left, uint32_t budget_us)
{
	uint32_t count = FIRST_PATCHES;
	if (p->item_us > 0) {
		const double fit = budget_us / p->item_us;
		count = fit < MOST_PATCHES ? (uint32_t)fit / PATCH_GROUP * PATCH_GROUP : MOST_PATCHES;
	}
	count = count < PATCH_GROUP ? PATCH_GROUP : count;
	return count < left ? count : left;
}
