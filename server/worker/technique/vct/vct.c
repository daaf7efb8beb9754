#include "server/worker/technique/vct/vct.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/angle.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/technique/deferred/deferred.h"
#include "server/worker/technique/direct/direct.h"
#include "server/worker/technique/direct/lighting.h"
#include "server/worker/technique/vct/vct_cones.h"
#include "server/worker/technique/vct/vct_figures.h"
#include "server/worker/technique/vct/vct_options.h"
#include "server/worker/technique/vct/vct_picture.h"
#include "server/worker/technique/vct/vct_show.h"
#include "server/worker/technique/vct/vct_volume.h"
#include "server/worker/trace/trace.h"
#include "shaders/gl/vct_direct_comp.h"
#include "shaders/shared/vct_show.h"

#define BUILD_SHARE 0.5 // share of the job's work that making the volume counts for

struct technique_job {
	struct lighting lighting;
	struct deferred *deferred;
	struct vct_volume *volume; // held; NULL: there is direct light alone
	struct vct_show *show; // what is shown of the voxels; NULL: the scene is
	struct resident_scene *scene;
	struct gl_device *device;
	void (*bind_lamps)(void *user,
			   const struct deferred_area *area); // the light pass's own, where shadows come from the volume
	void *lamps; // its user
	struct vct_picture picture; // its passes over the volume
};

static const struct gl_source direct_source = {.name = "vct_direct", .compute = source_vct_direct_comp};

// Finer voxels get more cones by default, because refining one alone leaves the error of the other.
static uint32_t cones_of(const struct plan *plan)
{
	const struct vct_settings *s = vct_settings(plan);
	const uint32_t r = s->resolution;
	const uint32_t wanted = s->cones ? s->cones : r <= 64 ? 6 : r <= 128 ? 9 : r <= 256 ? 16 : 32;
	return vct_cones_count(wanted);
}

static bool has_background(const struct plan *plan)
{
	return plan_has(plan, candil_Effect_EFFECT_ENVIRONMENT) && plan_has_colour(plan);
}

// Whether emissive surfaces light others through the voxels alone, by cones.
static bool lamps_in_volume(const struct plan *plan, const struct resident_scene *scene)
{
	return plan_has(plan, candil_Effect_EFFECT_EMITTERS) && scene_count(scene, BLOB_EMITTERS) > 0 &&
	       vct_settings(plan)->emitters == VCT_EMITTERS_CONES;
}

static struct lighting_wish wish_of(const struct plan *plan, const struct resident_scene *scene)
{
	const struct vct_settings *s = vct_settings(plan);
	const bool maps =
	    s->shadows == VCT_SHADOWS_MAP || (s->shadows == VCT_SHADOWS_RAYS && s->direct.shadows == DIRECT_SHADOWS_MAP);
	return lighting_wish_of(&s->direct, maps, !lamps_in_volume(plan, scene));
}

// Rays of each side of an entry. A pixel's ray takes the mean over many entries, so they need fewer than pixels.
static uint32_t voxel_rays(uint32_t rays)
{
	return rays / 4 > 4 ? rays / 4 : 4;
}

static void options_of(const struct plan *plan, const struct resident_scene *scene, struct vct_volume_options *o)
{
	const struct vct_settings *s = vct_settings(plan);
	const struct lighting_wish wish = wish_of(plan, scene);
	memset(o, 0, sizeof *o);
	o->voxels.resolution = s->resolution;
	o->voxels.cube = s->grid == VCT_GRID_CUBE;
	o->effects = plan->effects;
	o->bounces = plan_has(plan, candil_Effect_EFFECT_BOUNCES) ? s->bounces : 0;
	o->cones = cones_of(plan);
	o->points = wish.points;
	o->shadows = wish.shadows;
	o->map_side = shadow_maps_wanted(plan, scene, wish.map_side) ? wish.map_side : 0;
	o->pyramid = s->pyramid;
	o->cover = s->cover;
	o->own = s->own;
	o->lambert = s->lambert;
	o->volume_shadows = s->shadows;
	o->rays = s->gather == VCT_GATHER_BY_RAYS ? voxel_rays(s->rays) : 0;
	o->unmarched = !vct_options_march(plan);
	o->marching = s->marching;
	if (!(s->marching.ambient > 0))
		o->marching.falloff = 0;
	if (s->shadows == VCT_SHADOWS_CONES)
		o->marching.shadow_tangent = tanf(0.5f * s->shadow_aperture * (float)(PI / 180));
	o->emission = !wish.lamps;
	o->marching.step *= 2; // settings count in the cone's breadth, the shader in half of it
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
	       plan_has(plan, candil_Effect_EFFECT_GLASS) || lamps_in_volume(plan, scene) ||
	       vct_shadows_in_volume(vct_settings(plan)->shadows) || vct_settings(plan)->marching.ambient > 0;
}

static void bind_light(void *user, const struct deferred_area *area)
{
	const struct technique_job *j = user;
	j->bind_lamps(j->lamps, area);
	vct_volume_bind(j->volume);
}

// Make the light pass take its shadows from the volume.
static void take_shadows(struct technique_job *j, struct deferred_pass *pass)
{
	j->bind_lamps = pass->bind;
	j->lamps = pass->user;
	pass->source = &direct_source;
	pass->bind = bind_light;
	pass->user = j;
	vct_define(&pass->defines, &j->volume->options);
}

static uint64_t vct_bytes(const struct devices *devices, struct resident_scene *scene, const struct plan *plan)
{
	struct vct_volume_options options;
	uint64_t bytes = deferred_bytes(devices, plan, vct_settings(plan)->direct.rows);
	options_of(plan, scene, &options);
	if (vct_settings(plan)->show != VCT_SHOW_NONE)
		return bytes + vct_show_bytes_guess(scene, plan, &options);
	const struct lighting_wish wish = wish_of(plan, scene);
	bytes += lighting_bytes(devices, scene, plan, &wish);
	if (vct_needs_volume(plan, scene))
		bytes += vct_volume_bytes_guess(scene, &options) + vct_picture_bytes(devices->gl, plan);
	return bytes;
}

static void vct_advise(const struct devices *devices, struct resident_scene *scene, const struct plan *plan, uint64_t budget,
		       char *advice)
{
	struct plan smaller = *plan;
	struct vct_settings *s = vct_settings_of(&smaller);
	while (s->resolution > VOXEL_RESOLUTION_MIN && vct_bytes(devices, scene, &smaller) > budget)
		s->resolution /= 2;
	if (vct_bytes(devices, scene, &smaller) <= budget) {
		snprintf(advice, TECHNIQUE_ADVICE_BYTES, "vct.resolution=%u would fit", s->resolution);
		return;
	}
	const bool maps = shadow_maps_wanted(plan, scene, wish_of(plan, scene).map_side);
	direct_advise_map(vct_bytes, maps, devices, scene, &smaller, budget, advice);
}

static void vct_end(struct technique_job *job)
{
	if (!job)
		return;
	deferred_destroy(job->deferred);
	vct_picture_finish(&job->picture);
	lighting_finish(&job->lighting);
	vct_volume_release(job->volume);
	vct_show_destroy(job->show);
	free(job);
}

// Make the passes of the picture, and what they read.
static enum status make_passes(struct technique_job *j, struct devices *devices, const struct plan *plan,
			       struct deferred_pass *passes, uint32_t *count, struct error *err)
{
	struct vct_volume_options options;
	options_of(plan, j->scene, &options);
	if (vct_settings(plan)->show != VCT_SHOW_NONE) {
		enum status s = vct_show_create(j->scene, j->device, plan, &options, &j->show, err);
		if (s == STATUS_OK)
			vct_show_pass(j->show, &passes[0]);
		*count = 1;
		return s;
	}
	const struct lighting_wish wish = wish_of(plan, j->scene);
	enum status s = lighting_init(&j->lighting, devices, j->scene, plan, &wish, err);
	if (s != STATUS_OK)
		return s;
	*count = j->lighting.pass_count;
	memcpy(passes, j->lighting.passes, *count * sizeof *passes);
	if (!vct_needs_volume(plan, j->scene))
		return STATUS_OK;
	s = vct_volume_acquire(j->scene, j->device, plan, &options, &j->volume, err);
	if (s == STATUS_OK)
		s = vct_picture_init(&j->picture, j->device, plan, j->volume, err);
	if (s != STATUS_OK)
		return s;
	if (vct_shadows_in_volume(vct_settings(plan)->shadows))
		take_shadows(j, &passes[0]);
	*count = vct_picture_passes(&j->picture, plan, passes, *count);
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
		s = deferred_create(devices, scene, plan, vct_settings(plan)->direct.rows, TRACE_BINDINGS, passes, count,
				    &j->deferred, err);
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
	if (!lighting_ready(&j->lighting)) {
		result->fraction = j->volume ? BUILD_SHARE : 0;
		return lighting_step(&j->lighting, deferred_timer(j->deferred), budget_us, err);
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
	(*frame)->diagram = job->show != NULL;
	if (job->show && vct_show_finished(job->show))
		s = vct_show_figures(job->show, *frame, err);
	if (s != STATUS_OK)
		frame_destroy(*frame);
	return s;
}

// ---- planning -----------------------------------------------------------------------------------------------------------

static uint32_t vct_depth(const struct plan *plan)
{
	return vct_settings(plan)->bounces + 1;
}

// Why an effect is left out where the voxels are shown.
static const char *show_cannot(uint32_t show, candil_Effect effect)
{
	const bool light = show == VCT_SHOW_RADIANCE || show == VCT_SHOW_IRRADIANCE;
	if (show == VCT_SHOW_NONE)
		return NULL;
	if (effect == candil_Effect_EFFECT_NORMAL_MAPS)
		return "voxels have the mesh's own normals";
	if (!light && (effect == candil_Effect_EFFECT_LIGHTS || effect == candil_Effect_EFFECT_ENVIRONMENT ||
		       effect == candil_Effect_EFFECT_BOUNCES))
		return "what vct.show asks for needs no light";
	return NULL;
}

static const char *vct_cannot(const struct plan *plan, candil_Effect effect)
{
	return effect == candil_Effect_EFFECT_CAUSTICS
		   ? "light that comes from lamps by way of polished surfaces is not followed"
		   : show_cannot(vct_settings(plan)->show, effect);
}

// Reflections of glass come from the code for glossy surfaces, so glass switches it on. Where no surface is glossy this
// changes no other surface.
static void vct_settle(struct plan *plan, uint32_t allowed)
{
	if (plan_has(plan, candil_Effect_EFFECT_GLASS))
		plan->effects |= allowed & 1u << candil_Effect_EFFECT_GLOSSY;
}

const struct technique technique_vct = {.number = candil_Technique_TECHNIQUE_VCT,
					.options = vct_options,
					.needs = vct_needs,
					.defaults = vct_options_default,
					.check = vct_options_check,
					.depth = vct_depth,
					.effects = DEFERRED_EFFECTS | 1u << candil_Effect_EFFECT_BOUNCES |
						   1u << candil_Effect_EFFECT_GLASS,
					.cannot = vct_cannot,
					.sides_are_code = true,
					.settle = vct_settle,
					.notes = deferred_notes,
					.bytes = vct_bytes,
					.advise = vct_advise,
					.begin = vct_begin,
					.step = vct_step,
					.read = vct_read,
					.end = vct_end};
