#include "server/worker/technique/vct.h"

#include <stdlib.h>
#include <string.h>

#include "server/worker/technique/deferred.h"
#include "server/worker/technique/direct.h"
#include "server/worker/technique/scene_job.h"
#include "server/worker/technique/vct_cones.h"
#include "server/worker/technique/vct_volume.h"
#include "shaders/gl/vct_cones_comp.h"

#define BUILD_SHARE 0.5 // of the job's fraction, that making the volume counts for

struct technique_job {
	struct deferred *deferred;
	struct vct_volume *volume; // NULL: nothing comes but straight from the lights
};

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
	o->emission = direct_lamps_in_volume(plan, scene);
	o->step = 2 * plan->vct_step; // of the cone's breadth; the footprint is half of that
	o->start = plan->vct_start;
	o->dither = plan->vct_dither;
	if (has_background(plan))
		memcpy(o->background, plan->background, sizeof o->background);
}

static bool needs_volume(const struct plan *plan, const struct resident_scene *scene)
{
	return plan_has(plan, candil_Effect_EFFECT_BOUNCES) || plan_has(plan, candil_Effect_EFFECT_ENVIRONMENT) ||
	       direct_lamps_in_volume(plan, scene);
}

static void bind_volume(void *user, const struct deferred_area *area)
{
	(void)area;
	vct_volume_bind(user);
}

static uint64_t vct_bytes(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan)
{
	struct vct_options options;
	uint64_t bytes = deferred_bytes(devices, plan);
	options_of(plan, scene, &options);
	if (needs_volume(plan, scene))
		bytes += vct_volume_bytes_guess(scene, &options);
	return bytes;
}

static void vct_end(struct technique_job *job)
{
	if (!job)
		return;
	deferred_destroy(job->deferred);
	vct_volume_release(job->volume);
	free(job);
}

static enum status vct_begin(struct devices *devices, struct resident_scene *scene, const struct plan *plan,
			     struct technique_job **job, struct error *err)
{
	struct deferred_pass passes[DEFERRED_PASSES_MAX];
	struct vct_options options;
	struct gl_device *gl;
	struct technique_job *j = calloc(1, sizeof *j);
	if (!j)
		return error_set(err, STATUS_MEMORY, "out of memory");
	options_of(plan, scene, &options);
	uint32_t count = direct_passes(plan, scene, passes);
	enum status s = devices_gl(devices, &gl, err);
	if (s == STATUS_OK && needs_volume(plan, scene)) {
		s = vct_volume_acquire(scene, gl, plan, &options, &j->volume, err);
		passes[count++] = (struct deferred_pass){
		    .source = &cones_source, .stage = "cones", .bind = bind_volume, .user = j->volume};
	}
	if (s == STATUS_OK)
		s = deferred_create(devices, scene, plan, scene_bindings_trace(), passes, count, &j->deferred, err);
	if (s != STATUS_OK) {
		vct_end(j);
		return s;
	}
	*job = j;
	return STATUS_OK;
}

static enum status vct_step(struct technique_job *j, uint32_t budget_us, struct step_result *result, struct error *err)
{
	enum status s = STATUS_OK;
	if (j->volume && !vct_volume_finished(j->volume)) {
		s = vct_volume_step(j->volume, deferred_timer(j->deferred), budget_us, err);
		*result = (struct step_result){.fraction = BUILD_SHARE * vct_volume_fraction(j->volume)};
		return s;
	}
	s = deferred_step(j->deferred, budget_us, result, err);
	if (j->volume)
		result->fraction = BUILD_SHARE + (1 - BUILD_SHARE) * result->fraction;
	return s;
}

static enum status vct_read(struct technique_job *job, struct frame **frame, struct error *err)
{
	return deferred_read(job->deferred, frame, err);
}

const struct technique technique_vct = {
    .name = "vct", .bytes = vct_bytes, .begin = vct_begin, .step = vct_step, .read = vct_read, .end = vct_end};
