#include "server/worker/technique/direct.h"

#include <stdlib.h>

#include "server/worker/technique/scene_job.h"
#include "shaders/gl/light_comp.h"

#define CLOSED_EMITTERS_MAX 32u

struct technique_job {
	struct deferred *deferred;
};

static const struct gl_source light_source = {.name = "light", .compute = source_light_comp};

// Whether what the emissive triangles send can be summed in closed form: few, and none with a texture in its emission.
static bool lamps_are_plain(const struct plan *plan, const struct resident_scene *scene)
{
	const struct emitter *emitters = scene_section(scene, BLOB_EMITTERS);
	const struct triangle *triangles = scene_section(scene, BLOB_TRIANGLES);
	const struct material *materials = scene_section(scene, BLOB_MATERIALS);
	const uint32_t count = scene_count(scene, BLOB_EMITTERS);
	if (count > CLOSED_EMITTERS_MAX)
		return false;
	for (uint32_t i = 0; i < count; i++)
		if (plan_has(plan, candil_Effect_EFFECT_TEXTURES) &&
		    materials[triangles[emitters[i].triangle].material].emission_texture != NONE)
			return false;
	return true;
}

bool direct_lamps_in_volume(const struct plan *plan, const struct resident_scene *scene)
{
	if (plan->technique != candil_Technique_TECHNIQUE_VCT || !plan_has(plan, candil_Effect_EFFECT_EMITTERS) ||
	    scene_count(scene, BLOB_EMITTERS) == 0 || plan->vct_emitters == VCT_EMITTERS_POINTS)
		return false;
	return plan->vct_emitters == VCT_EMITTERS_CONES || !lamps_are_plain(plan, scene);
}

void direct_define(struct gl_defines *defines, const struct plan *plan, const struct resident_scene *scene)
{
	gl_define(defines, "DIRECT_POINTS", "%uu", plan->direct_points);
	gl_define(defines, "DIRECT_CLOSED", "%s", lamps_are_plain(plan, scene) ? "true" : "false");
	gl_define(defines, "DIRECT_LAMPS", "%s", direct_lamps_in_volume(plan, scene) ? "false" : "true");
	gl_define(defines, "DIRECT_SHADOWS", "%s", plan->direct_shadows == DIRECT_SHADOWS_NONE ? "false" : "true");
}

uint32_t direct_passes(const struct plan *plan, const struct resident_scene *scene, struct deferred_pass passes[2])
{
	passes[0] = (struct deferred_pass){.source = &light_source, .stage = "light"};
	direct_define(&passes[0].defines, plan, scene);
	return 1;
}

static uint64_t direct_bytes(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan)
{
	(void)scene;
	return deferred_bytes(devices, plan);
}

static void direct_end(struct technique_job *job)
{
	if (job)
		deferred_destroy(job->deferred);
	free(job);
}

static enum status direct_begin(struct devices *devices, struct resident_scene *scene, const struct plan *plan,
				struct technique_job **job, struct error *err)
{
	struct deferred_pass passes[2];
	struct technique_job *j = calloc(1, sizeof *j);
	if (!j)
		return error_set(err, STATUS_MEMORY, "out of memory");
	const uint32_t count = direct_passes(plan, scene, passes);
	enum status s = deferred_create(devices, scene, plan, scene_bindings_trace(), passes, count, &j->deferred, err);
	if (s != STATUS_OK) {
		direct_end(j);
		return s;
	}
	*job = j;
	return STATUS_OK;
}

static enum status direct_step(struct technique_job *job, uint32_t budget_us, struct step_result *result, struct error *err)
{
	return deferred_step(job->deferred, budget_us, result, err);
}

static enum status direct_read(struct technique_job *job, struct frame **frame, struct error *err)
{
	return deferred_read(job->deferred, frame, err);
}

const struct technique technique_direct = {.name = "direct",
					   .bytes = direct_bytes,
					   .begin = direct_begin,
					   .step = direct_step,
					   .read = direct_read,
					   .end = direct_end};
