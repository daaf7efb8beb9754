#include "server/worker/technique/direct.h"

#include <epoxy/gl.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/worker/technique/scene_params.h"
#include "shaders/gl/light_comp.h"
#include "shaders/gl/soften_comp.h"
#include "shaders/shared/deferred.h"

#define CLOSED_EMITTERS_MAX 32u

struct technique_job {
	struct direct_lighting lighting;
	struct deferred *deferred;
};

static const struct gl_source light_source = {.name = "light", .compute = source_light_comp};
static const struct gl_source soften_source = {.name = "soften", .compute = source_soften_comp};

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
	return plan->technique == candil_Technique_TECHNIQUE_VCT && plan_has(plan, candil_Effect_EFFECT_EMITTERS) &&
	       scene_count(scene, BLOB_EMITTERS) > 0 && plan->vct_emitters == VCT_EMITTERS_CONES;
}

// Whether lamps light the scene, by points that neighbouring pixels share.
static bool is_soft(const struct plan *plan, const struct resident_scene *scene)
{
	return plan_has(plan, candil_Effect_EFFECT_EMITTERS) && scene_count(scene, BLOB_EMITTERS) > 0 &&
	       !direct_lamps_in_volume(plan, scene) && plan->samples < DIRECT_SOFT_BELOW;
}

static const char *word(bool value)
{
	return value ? "true" : "false";
}

void direct_define(struct gl_defines *defines, const struct plan *plan, const struct resident_scene *scene)
{
	gl_define(defines, "DIRECT_POINTS", "%uu", plan->direct_points);
	gl_define(defines, "DIRECT_CLOSED", "%s", word(lamps_are_plain(plan, scene) && plan->samples < DIRECT_SOFT_BELOW));
	gl_define(defines, "DIRECT_LAMPS", "%s", word(!direct_lamps_in_volume(plan, scene)));
	gl_define(defines, "DIRECT_SHADOWS", "%s", word(plan->direct_shadows != DIRECT_SHADOWS_NONE));
	gl_define(defines, "DIRECT_SOFT", "%s", word(is_soft(plan, scene)));
	if (plan_has_sky(plan))
		gl_define(defines, "DIRECT_SKY", "true");
	if (!shadow_maps_wanted(plan, scene))
		return;
	gl_define(defines, "DIRECT_MAPS", "true");
	gl_define(defines, "DIRECT_MAPS_FOR_ALL", "%s", word(shadow_maps_for_all(scene)));
}

// ---- the passes ---------------------------------------------------------------------------------------------------------

static struct gl_texture_desc lamp_desc(const struct gl_device *device, const struct plan *plan)
{
	return (struct gl_texture_desc){.target = GL_TEXTURE_2D,
					.format = GL_RGBA32F,
					.width = plan->width,
					.height = deferred_band_rows(device, plan),
					.depth = 1,
					.levels = 1};
}

uint64_t direct_lighting_bytes(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan)
{
	const struct gl_texture_desc desc = lamp_desc(devices->gl, plan);
	const uint64_t maps = shadow_maps_bytes(plan, scene);
	const uint32_t images = !is_soft(plan, scene) ? 0 : plan_has(plan, candil_Effect_EFFECT_GLOSSY) ? 4 : 3;
	return maps + images * gl_texture_bytes(&desc);
}

static void bind_lamps(void *user, const struct deferred_area *area)
{
	const struct direct_lighting *l = user;
	(void)area;
	if (l->maps)
		shadow_maps_bind(l->maps);
	if (l->sky)
		sky_map_bind(l->sky);
	if (!l->scale.name)
		return;
	gl_texture_bind_image(&l->scale, DIRECT_SCALE_UNIT, 0, GL_READ_WRITE);
	gl_texture_bind_image(&l->arrived, DIRECT_ARRIVED_UNIT, 0, GL_READ_WRITE);
	gl_texture_bind_image(&l->expected, DIRECT_EXPECTED_UNIT, 0, GL_READ_WRITE);
	if (l->facets.name)
		gl_texture_bind_image(&l->facets, DIRECT_FACETS_UNIT, 0, GL_READ_WRITE);
}

static void add_pass(struct direct_lighting *l, const struct gl_source *source, const struct plan *plan,
		     const struct resident_scene *scene)
{
	struct deferred_pass *pass = &l->passes[l->pass_count++];
	*pass = (struct deferred_pass){.source = source, .stage = source->name, .bind = bind_lamps, .user = l};
	direct_define(&pass->defines, plan, scene);
}

static enum status make_images(struct direct_lighting *l, const struct plan *plan, struct error *err)
{
	const struct gl_texture_desc desc = lamp_desc(l->device, plan);
	enum status s = gl_texture_init(&l->scale, l->device, &desc, err);
	if (s == STATUS_OK)
		s = gl_texture_init(&l->arrived, l->device, &desc, err);
	if (s == STATUS_OK)
		s = gl_texture_init(&l->expected, l->device, &desc, err);
	if (s == STATUS_OK && plan_has(plan, candil_Effect_EFFECT_GLOSSY))
		s = gl_texture_init(&l->facets, l->device, &desc, err);
	return s;
}

enum status direct_lighting_init(struct direct_lighting *l, struct devices *devices, struct resident_scene *scene,
				 const struct plan *plan, struct error *err)
{
	*l = (struct direct_lighting){0};
	enum status s = devices_gl(devices, &l->device, err);
	if (s == STATUS_OK && plan_has_sky(plan))
		s = sky_map_get(plan->environment.scene, l->device, &l->sky, err);
	if (s == STATUS_OK && shadow_maps_wanted(plan, scene))
		s = shadow_maps_acquire(scene, l->device, plan, &l->compile_us, &l->maps, err);
	if (s != STATUS_OK)
		return s;
	add_pass(l, &light_source, plan, scene);
	if (!is_soft(plan, scene))
		return STATUS_OK;
	add_pass(l, &soften_source, plan, scene);
	s = make_images(l, plan, err);
	if (s != STATUS_OK)
		direct_lighting_finish(l);
	return s;
}

void direct_lighting_finish(struct direct_lighting *l)
{
	if (!l->device)
		return;
	gl_texture_finish(&l->scale, l->device);
	gl_texture_finish(&l->arrived, l->device);
	gl_texture_finish(&l->expected, l->device);
	gl_texture_finish(&l->facets, l->device);
	shadow_maps_release(l->maps);
	l->maps = NULL;
}

enum status direct_lighting_step(struct direct_lighting *l, struct gl_timer *timer, uint32_t budget_us, struct error *err)
{
	return l->maps ? shadow_maps_step(l->maps, timer, budget_us, err) : STATUS_OK;
}

bool direct_lighting_ready(const struct direct_lighting *l)
{
	return !l->maps || shadow_maps_finished(l->maps);
}

// ---- the technique ------------------------------------------------------------------------------------------------------

static uint64_t direct_bytes(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan)
{
	return deferred_bytes(devices, plan) + direct_lighting_bytes(devices, scene, plan);
}

void direct_advise_map(uint64_t (*bytes)(const struct devices *devices, const struct resident_scene *scene,
					 const struct plan *plan),
		       const struct devices *devices, const struct resident_scene *scene, const struct plan *plan,
		       uint64_t budget, char *advice)
{
	struct plan smaller = *plan;
	if (!shadow_maps_wanted(plan, scene))
		return;
	while (smaller.direct_map > PLAN_MAP_LEAST && bytes(devices, scene, &smaller) > budget)
		smaller.direct_map /= 2;
	if (bytes(devices, scene, &smaller) <= budget)
		snprintf(advice, TECHNIQUE_ADVICE_BYTES, "direct.map=%u would fit", smaller.direct_map);
}

static void direct_advise(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan,
			  uint64_t budget, char *advice)
{
	direct_advise_map(direct_bytes, devices, scene, plan, budget, advice);
}

static void direct_end(struct technique_job *job)
{
	if (!job)
		return;
	deferred_destroy(job->deferred);
	direct_lighting_finish(&job->lighting);
	free(job);
}

static enum status direct_begin(struct devices *devices, struct resident_scene *scene, const struct plan *plan,
				struct technique_job **job, struct error *err)
{
	struct technique_job *j = calloc(1, sizeof *j);
	if (!j)
		return error_set(err, STATUS_MEMORY, "out of memory");
	struct direct_lighting *l = &j->lighting;
	enum status s = direct_lighting_init(l, devices, scene, plan, err);
	if (s == STATUS_OK)
		s = deferred_create(devices, scene, plan, scene_bindings_trace(), l->passes, l->pass_count, &j->deferred,
				    err);
	if (s != STATUS_OK) {
		direct_end(j);
		return s;
	}
	deferred_add_setup(j->deferred, 0, l->compile_us);
	*job = j;
	return STATUS_OK;
}

static enum status direct_step(struct technique_job *job, uint32_t budget_us, struct step_result *result, struct error *err)
{
	struct direct_lighting *l = &job->lighting;
	if (direct_lighting_ready(l))
		return deferred_step(job->deferred, budget_us, result, err);
	return direct_lighting_step(l, deferred_timer(job->deferred), budget_us, err);
}

static enum status direct_read(struct technique_job *job, struct frame **frame, struct error *err)
{
	return deferred_read(job->deferred, frame, err);
}

const struct technique technique_direct = {.name = "direct",
					   .bytes = direct_bytes,
					   .advise = direct_advise,
					   .begin = direct_begin,
					   .step = direct_step,
					   .read = direct_read,
					   .end = direct_end};
