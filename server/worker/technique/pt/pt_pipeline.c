// What every pass of the path tracer is made of: a variant of its shader, its bindings and its first run. Used by
// pt_setup.c, pt_light.c and pt_effects.c.
#include "protocol/names.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/technique/common/scene_traits.h"
#include "server/worker/technique/pt/pt_cells.h"
#include "server/worker/technique/pt/pt_job.h"
#include "server/worker/technique/pt/pt_light.h"
#include "server/worker/technique/pt/pt_light_tree.h"
#include "server/worker/technique/pt/pt_options.h"
#include "server/worker/vk/command.h"

_Static_assert(FILTER_BOX == (int)candil_Filter_FILTER_BOX && FILTER_GAUSSIAN == (int)candil_Filter_FILTER_GAUSSIAN &&
		   FILTER_BLACKMAN_HARRIS == (int)candil_Filter_FILTER_BLACKMAN_HARRIS,
	       "one number a filter");
_Static_assert(BIND_PATH_COUNT <= BIND_MOST && BIND_LIGHT_COUNT <= BIND_MOST && BIND_TRACE_COUNT <= BIND_MOST &&
		   BIND_ERROR_COUNT <= BIND_MOST,
	       "a binding set has room for every pass");
_Static_assert(EFFECT_COUNT + SPEC_END - SPEC_EFFECTS + SPEC_SCENE_END - SPEC_SCENE <= PIPELINE_CONSTANTS_MAX &&
		   SPEC_END <= SPEC_SCENE,
	       "a pipeline has room for every effect and every constant of a pass");

enum status pt_job_bind(struct technique_job *j, struct pipeline *pipeline, const struct buffer *result,
			struct binding_set *set, struct error *err)
{
	const struct buffer *buffers[BIND_MOST] = {NULL};
	trace_fill_buffers(j->scene, buffers);
	if (j->cells) {
		buffers[BIND_EMITTERS] = &j->cells->emitters;
		buffers[BIND_EMITTER_GRIDS] = &j->cells->grids;
		buffers[BIND_EMITTER_CELLS] = &j->cells->cells;
	}
	if (j->tree) {
		buffers[BIND_LIGHT_NODES] = &j->tree->nodes;
		buffers[BIND_LIGHT_TRAILS] = &j->tree->trails;
	}
	buffers[BIND_JOB] = &j->job;
	buffers[BIND_COUNTERS] = &j->counters;
	if (j->sky) {
		buffers[BIND_ENVIRONMENT] = &j->sky->texels;
		buffers[BIND_ENVIRONMENT_ROWS] = &j->sky->rows;
	}
	buffers[BIND_ACCUMULATOR] = result;
	buffers[BIND_PATHS] = &j->paths;
	buffers[BIND_CASTERS] = &j->casters;
	buffers[BIND_CASTER_DENSITY] = &j->caster_density;
	return binding_set_init(set, j->device, pipeline, buffers, &j->counters_host, err);
}

enum status pt_job_warm_up(struct technique_job *j, struct pipeline *pipeline, const struct binding_set *set,
			   struct error *err)
{
	VkCommandBuffer c = j->device->commands;
	const struct path_push nothing = {.first_tile = j->tiles};
	if (pipeline->warm)
		return STATUS_OK;
	enum status s = command_begin(j->device, err);
	if (s != STATUS_OK)
		return s;
	vkCmdBindPipeline(c, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline->handle);
	vkCmdBindDescriptorSets(c, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline->layout, 0, 1, &set->set, 0, NULL);
	vkCmdPushConstants(c, pipeline->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof nothing, &nothing);
	vkCmdDispatch(c, 1, 1, 1);
	s = command_finish(j->device, err);
	if (s == STATUS_OK)
		pipeline_has_run(j->device, pipeline);
	return s;
}

static bool has_priorities(const struct resident_scene *scene)
{
	const struct material *materials = scene_section(scene, BLOB_MATERIALS);
	for (uint32_t i = 0; i < scene_count(scene, BLOB_MATERIALS); i++)
		if (materials[i].flags >> MATERIAL_PRIORITY_SHIFT)
			return true;
	return false;
}

enum status pt_job_make_pipeline(struct technique_job *j, const struct shader *shader, uint32_t effects,
				 struct pipeline **pipeline, struct error *err)
{
	struct constants c = {0};
	scene_set_constants(&c, j->scene, effects);
	constants_set(&c, SPEC_RESUMED, j->segments > 1);
	trace_set_constants(&j->trace, &c);
	constants_set(&c, SPEC_CAMERA,
		      j->plan.camera.panorama          ? CAMERA_PANORAMA
		      : j->plan.camera.lens_radius > 0 ? CAMERA_LENS
						       : CAMERA_PINHOLE);
	constants_set(&c, SPEC_FILTER, j->plan.filter);
	pt_options_set_constants(pt_settings(&j->plan), &c);
	constants_set(&c, SPEC_SKY, j->plan.environment.power > 0 && effects >> candil_Effect_EFFECT_ENVIRONMENT & 1u);
	constants_set(&c, SPEC_DISCS, effects >> candil_Effect_EFFECT_LIGHTS & 1u && scene_has_discs(j->scene));
	constants_set(&c, SPEC_LIGHT_TREE, j->tree != NULL);
	constants_set(&c, SPEC_EMITTER_CELLS,
		      j->cells && effects >> candil_Effect_EFFECT_EMITTERS & effects >> candil_Effect_EFFECT_TEXTURES & 1u);
	constants_set(&c, SPEC_PRIORITIES, effects >> candil_Effect_EFFECT_GLASS & 1u && has_priorities(j->scene));
	return pipeline_get(j->device, shader, &c, pipeline, err);
}

struct path_push pt_job_push(const struct technique_job *j, const struct pt_band *band)
{
	return (struct path_push){.first_row = band->first_row,
				  .first_sample = j->plan.first_sample + j->sample,
				  .sample_count = j->batch,
				  .round_count = j->segment * j->batch,
				  .band_rows = band->rows,
				  .light_tiles = pt_light_tiles(band->tiles)};
}

void pt_job_record(const struct technique_job *j, const struct pipeline *pipeline, const struct binding_set *set,
		   struct path_push push, uint32_t dispatches)
{
	VkCommandBuffer c = j->device->commands;
	vkCmdBindPipeline(c, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline->handle);
	vkCmdBindDescriptorSets(c, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline->layout, 0, 1, &set->set, 0, NULL);
	for (uint32_t i = 0; i < dispatches; i++) {
		push.resumes = i > 0;
		vkCmdPushConstants(c, pipeline->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
		vkCmdDispatch(c, push.tile_count, 1, 1);
		// The next dispatch may add to the same pixels, or continue the same paths.
		command_barrier(j->device);
	}
}
