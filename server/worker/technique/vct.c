#include "server/worker/technique/vct.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/angle.h"
#include "server/worker/technique/deferred.h"
#include "server/worker/technique/direct.h"
#include "server/worker/technique/scene_params.h"
#include "server/worker/technique/vct_cones.h"
#include "server/worker/technique/vct_figures.h"
#include "server/worker/technique/vct_show.h"
#include "server/worker/technique/vct_volume.h"
#include "shaders/gl/vct_coarse_comp.h"
#include "shaders/gl/vct_cones_comp.h"
#include "shaders/gl/vct_direct_comp.h"
#include "shaders/gl/vct_fine_comp.h"
#include "shaders/shared/vct_show.h"

#define BUILD_SHARE 0.5 // of the job's fraction, that making the volume counts for

struct technique_job {
	struct direct_lighting lighting;
	struct deferred *deferred;
	struct vct_volume *volume; // NULL: nothing comes but straight from the lights
	struct vct_show *show; // or the voxels themselves; NULL: the scene
	struct resident_scene *scene;
	struct gl_device *device;
	void (*bind_lamps)(void *user,
			   const struct deferred_area *area); // of the light pass, with shadows out of the volume
	void *lamps;
	struct gl_texture irradiance, facets; // with VCT_DETAIL_HALF: shaders/vct/half.glsl
};

static const struct gl_source coarse_source = {.name = "vct_coarse", .compute = source_vct_coarse_comp};
static const struct gl_source direct_source = {.name = "vct_direct", .compute = source_vct_direct_comp};
static const struct gl_source fine_source = {.name = "vct_fine", .compute = source_vct_fine_comp};
static const struct gl_source cones_source = {.name = "vct_cones", .compute = source_vct_cones_comp};

// The finer the voxels, the more cones: either alone leaves the other's error.
static uint32_t cones_of(const struct plan *plan)
{
	const uint32_t r = plan->vct_resolution;
	const uint32_t wanted = plan->vct_cones ? plan->vct_cones : r <= 64 ? 6 : r <= 128 ? 9 : r <= 256 ? 16 : 32;
	return vct_cones_count(wanted);
}

static bool has_background(const struct plan *plan)
{
	return plan_has(plan, candil_Effect_EFFECT_ENVIRONMENT) &&
	       (plan->background[0] > 0 || plan->background[1] > 0 || plan->background[2] > 0);
}

static void options_of(const struct plan *plan, const struct resident_scene *scene, struct vct_options *o)
{
	memset(o, 0, sizeof *o);
	o->voxels.resolution = plan->vct_resolution;
	o->voxels.cube = plan->vct_grid == VCT_GRID_CUBE;
	o->effects = plan->effects;
	o->bounces = plan_has(plan, candil_Effect_EFFECT_BOUNCES) ? plan->vct_bounces : 0;
	o->cones = cones_of(plan);
	o->points = plan->direct_points;
	o->shadows = plan->direct_shadows;
	o->map_side = shadow_maps_wanted(plan, scene) ? plan->direct_map : 0;
	o->pyramid = plan->vct_pyramid;
	o->cover = plan->vct_cover;
	o->own = plan->vct_own;
	o->lambert = plan->vct_lambert;
	o->volume_shadows = plan->vct_shadows;
	if (plan->vct_shadows == VCT_SHADOWS_CONES)
		o->shadow_tangent = tanf(0.5f * plan->vct_shadow_aperture * (float)(PI / 180));
	o->reach = plan->vct_distance;
	o->ambient = plan->vct_ambient;
	o->falloff = plan->vct_ambient > 0 ? plan->vct_ao : 0;
	o->emission = direct_lamps_in_volume(plan, scene);
	o->step = 2 * plan->vct_step; // of the cone's breadth; the footprint is half of that
	o->start = plan->vct_start;
	o->dither = plan->vct_dither;
	if (plan_has_sky(plan)) {
		o->sky = plan->environment.scene->id;
		o->sky_turn = (float)plan->environment.turn;
		o->sky_scale = (float)plan->environment.scale;
	}
	if (has_background(plan))
		memcpy(o->background, plan->background, sizeof o->background);
}

static bool vct_needs_volume(const struct plan *plan, const struct resident_scene *scene)
{
	return plan_has(plan, candil_Effect_EFFECT_BOUNCES) || plan_has(plan, candil_Effect_EFFECT_ENVIRONMENT) ||
	       plan_has(plan, candil_Effect_EFFECT_GLASS) || direct_lamps_in_volume(plan, scene) ||
	       vct_shadows_in_volume(plan->vct_shadows) || plan->vct_ambient > 0;
}

static void bind_volume(void *user, const struct deferred_area *area)
{
	(void)area;
	const struct technique_job *j = user;
	vct_volume_bind(j->volume);
	if (!j->irradiance.name)
		return;
	gl_texture_bind(&j->irradiance, VCT_IRRADIANCE_UNIT);
	gl_texture_bind(&j->facets, VCT_FACETS_UNIT);
	gl_texture_bind_image(&j->irradiance, VCT_IRRADIANCE_IMAGE, 0, GL_WRITE_ONLY);
	gl_texture_bind_image(&j->facets, VCT_FACETS_IMAGE, 0, GL_WRITE_ONLY);
}

// The passes for light between surfaces, behind `count` others.
static uint32_t cone_passes(struct technique_job *j, const struct plan *plan, struct deferred_pass *passes, uint32_t count)
{
	struct deferred_pass pass = {.stage = "cones", .bind = bind_volume, .user = j};
	vct_define(&pass.defines, &j->volume->options);
	passes[count] = pass;
	passes[count].source = plan->vct_detail == VCT_DETAIL_HALF ? &coarse_source : &cones_source;
	if (plan->vct_detail == VCT_DETAIL_FULL)
		return count + 1;
	passes[count + 1] = pass;
	passes[count + 1].source = &fine_source;
	return count + 2;
}

static void bind_light(void *user, const struct deferred_area *area)
{
	const struct technique_job *j = user;
	j->bind_lamps(j->lamps, area);
	vct_volume_bind(j->volume);
}

// The light pass with shadows out of the volume.
static void take_shadows(struct technique_job *j, struct deferred_pass *pass)
{
	j->bind_lamps = pass->bind;
	j->lamps = pass->user;
	pass->source = &direct_source;
	pass->bind = bind_light;
	pass->user = j;
	vct_define(&pass->defines, &j->volume->options);
}

static struct gl_texture_desc half_desc(const struct gl_device *gl, const struct plan *plan)
{
	return (struct gl_texture_desc){.target = GL_TEXTURE_2D,
					.format = GL_RGBA32F,
					.width = (plan->width + 1) / 2,
					.height = (deferred_band_rows(gl, plan) + 1) / 2,
					.depth = 1,
					.levels = 1};
}

static enum status make_half(struct technique_job *j, const struct plan *plan, struct error *err)
{
	const struct gl_texture_desc desc = half_desc(j->device, plan);
	if (plan->vct_detail == VCT_DETAIL_FULL)
		return STATUS_OK;
	enum status s = gl_texture_init(&j->irradiance, j->device, &desc, err);
	return s == STATUS_OK ? gl_texture_init(&j->facets, j->device, &desc, err) : s;
}

static uint64_t vct_bytes(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan)
{
	struct vct_options options;
	uint64_t bytes = deferred_bytes(devices, plan);
	options_of(plan, scene, &options);
	if (plan->vct_show != VCT_SHOW_NONE)
		return bytes + vct_show_bytes_guess(scene, plan, &options);
	bytes += direct_lighting_bytes(devices, scene, plan);
	if (vct_needs_volume(plan, scene))
		bytes += vct_volume_bytes_guess(scene, &options);
	return bytes;
}

static void vct_advise(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan,
		       uint64_t budget, char *advice)
{
	struct plan smaller = *plan;
	while (smaller.vct_resolution > VOXEL_RESOLUTION_MIN && vct_bytes(devices, scene, &smaller) > budget)
		smaller.vct_resolution /= 2;
	if (vct_bytes(devices, scene, &smaller) <= budget)
		snprintf(advice, TECHNIQUE_ADVICE_BYTES, "vct.resolution=%u would fit", smaller.vct_resolution);
	else
		direct_advise_map(vct_bytes, devices, scene, &smaller, budget, advice);
}

static void vct_end(struct technique_job *job)
{
	if (!job)
		return;
	deferred_destroy(job->deferred);
	gl_texture_finish(&job->irradiance, job->device);
	gl_texture_finish(&job->facets, job->device);
	direct_lighting_finish(&job->lighting);
	vct_volume_release(job->volume);
	vct_show_destroy(job->show);
	free(job);
}

// The passes of the picture, and what they read.
static enum status make_passes(struct technique_job *j, struct devices *devices, const struct plan *plan,
			       struct deferred_pass *passes, uint32_t *count, struct error *err)
{
	struct vct_options options;
	options_of(plan, j->scene, &options);
	if (plan->vct_show != VCT_SHOW_NONE) {
		enum status s = vct_show_create(j->scene, j->device, plan, &options, &j->show, err);
		if (s == STATUS_OK)
			vct_show_pass(j->show, &passes[0]);
		*count = 1;
		return s;
	}
	enum status s = direct_lighting_init(&j->lighting, devices, j->scene, plan, err);
	if (s != STATUS_OK)
		return s;
	*count = j->lighting.pass_count;
	memcpy(passes, j->lighting.passes, *count * sizeof *passes);
	if (!vct_needs_volume(plan, j->scene))
		return STATUS_OK;
	s = vct_volume_acquire(j->scene, j->device, plan, &options, &j->volume, err);
	if (s == STATUS_OK)
		s = make_half(j, plan, err);
	if (s != STATUS_OK)
		return s;
	if (vct_shadows_in_volume(plan->vct_shadows))
		take_shadows(j, &passes[0]);
	*count = cone_passes(j, plan, passes, *count);
	return STATUS_OK;
}

static enum status vct_begin(struct devices *devices, struct resident_scene *scene, const struct plan *plan,
			     struct technique_job **job, struct error *err)
{
	struct deferred_pass passes[DEFERRED_PASSES_MAX];
	uint32_t count = 0;
	struct technique_job *j = calloc(1, sizeof *j);
	if (!j)
		return error_set(err, STATUS_MEMORY, "out of memory");
	j->scene = scene;
	enum status s = devices_gl(devices, &j->device, err);
	if (s == STATUS_OK)
		s = make_passes(j, devices, plan, passes, &count, err);
	if (s == STATUS_OK)
		s = deferred_create(devices, scene, plan, scene_bindings_trace(), passes, count, &j->deferred, err);
	if (s != STATUS_OK) {
		vct_end(j);
		return s;
	}
	deferred_add_setup(j->deferred, 0, j->lighting.compile_us);
	*job = j;
	return STATUS_OK;
}

static enum status vct_step(struct technique_job *j, uint32_t budget_us, struct step_result *result, struct error *err)
{
	enum status s = STATUS_OK;
	if (j->show && !vct_show_finished(j->show)) {
		s = vct_show_step(j->show, deferred_timer(j->deferred), budget_us, err);
		result->fraction = BUILD_SHARE * vct_show_fraction(j->show);
		return s;
	}
	if (j->volume && !vct_volume_finished(j->volume)) {
		s = vct_volume_step(j->volume, deferred_timer(j->deferred), budget_us, err);
		result->fraction = BUILD_SHARE * vct_volume_fraction(j->volume);
		return s;
	}
	if (!direct_lighting_ready(&j->lighting)) {
		result->fraction = j->volume ? BUILD_SHARE : 0;
		return direct_lighting_step(&j->lighting, deferred_timer(j->deferred), budget_us, err);
	}
	s = deferred_step(j->deferred, budget_us, result, err);
	if (j->volume || j->show)
		result->fraction = BUILD_SHARE + (1 - BUILD_SHARE) * result->fraction;
	return s;
}

static enum status vct_read(struct technique_job *job, struct frame **frame, struct error *err)
{
	enum status s = deferred_read(job->deferred, frame, err);
	if (s != STATUS_OK)
		return s;
	if (job->volume && vct_volume_finished(job->volume))
		vct_figures(*frame, job->volume->voxels, job->volume, job->scene->blob->origin);
	if (job->show && vct_show_finished(job->show))
		s = vct_show_figures(job->show, *frame, err);
	if (s != STATUS_OK)
		frame_destroy(*frame);
	return s;
}

const struct technique technique_vct = {.name = "vct",
					.bytes = vct_bytes,
					.advise = vct_advise,
					.begin = vct_begin,
					.step = vct_step,
					.read = vct_read,
					.end = vct_end};
