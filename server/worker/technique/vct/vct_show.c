#include "server/worker/technique/vct/vct_show.h"

#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/worker/technique/vct/vct_figures.h"
#include "server/worker/technique/vct/vct_options.h"
#include "shaders/gl/vct_show_comp.h"
#include "shaders/shared/vct_show.h"

struct vct_show {
	struct plan plan;
	struct resident_scene *scene;
	struct vct_volume *volume; // held; NULL: the voxels are enough
	struct voxels *voxels; // the volume's, or held by us if there is none
	uint32_t where[4], corner[2]; // VCT_SHOW_WHERE, VCT_SHOW_CORNER
};

static const struct gl_source show_source = {.name = "vct_show", .compute = source_vct_show_comp};

// Whether a volume without light is enough: the coverage in the pyramid's levels does not depend on light.
static bool in_the_dark(const struct plan *plan)
{
	return vct_settings(plan)->show == VCT_SHOW_COVERAGE && vct_settings(plan)->level > 0;
}

static bool vct_show_needs_volume(const struct plan *plan)
{
	return vct_settings(plan)->show == VCT_SHOW_RADIANCE || vct_settings(plan)->show == VCT_SHOW_IRRADIANCE ||
	       in_the_dark(plan);
}

static void darken(struct plan *plan, struct vct_volume_options *o)
{
	plan->effects &= ~(1u << candil_Effect_EFFECT_LIGHTS | 1u << candil_Effect_EFFECT_ENVIRONMENT |
			   1u << candil_Effect_EFFECT_BOUNCES);
	o->effects = plan->effects;
	o->bounces = o->rays = 0;
	o->volume_shadows = VCT_SHADOWS_RAYS;
	o->map_side = 0;
	o->marching.ambient = o->marching.falloff = 0;
	o->emission = 1; // emission is in the pyramid; no shadow rays go to emissive triangles
	memset(o->background, 0, sizeof o->background);
	o->sky = 0;
	o->sky_turn = o->sky_scale = 0;
}

static uint32_t top_of(const struct vct_show *s)
{
	return s->volume ? s->volume->params.top + 1 : 0;
}

// Which cells of which level are shown, and how large they are in the image.
static enum status place_slice(struct vct_show *s, struct error *err)
{
	const struct plan *p = &s->plan;
	const struct vct_settings *wish = vct_settings(p);
	const uint32_t *all = s->voxels->grid.sides;
	const uint32_t level = wish->level, axis = wish->axis;
	const uint32_t wide = all[axis == 0 ? 2 : 0] >> level, high = all[axis == 1 ? 2 : 1] >> level;
	const uint32_t across = p->width / wide, down = p->height / high;
	const uint32_t side = across < down ? across : down;
	if (wish->slice >= all[axis] >> level)
		return error_set(err, STATUS_BAD_ARGUMENT, "there is no slice %u: level %u has %u along this axis, from 0",
				 wish->slice, level, all[axis] >> level);
	if (side == 0)
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "a slice has %u x %u cells: ask for a picture of at least as many pixels", wide, high);
	s->where[3] = side;
	s->corner[0] = (p->width - side * wide) / 2;
	s->corner[1] = (p->height - side * high) / 2;
	return STATUS_OK;
}

static enum status vct_show_place(struct vct_show *s, struct error *err)
{
	const struct vct_settings *wish = vct_settings(&s->plan);
	if (wish->level > top_of(s))
		return error_set(err, STATUS_BAD_ARGUMENT, "there is no level %u: these voxels have levels 0 to %u",
				 wish->level, top_of(s));
	s->where[0] = wish->level;
	s->where[1] = wish->axis;
	s->where[2] = wish->slice;
	s->where[3] = 1;
	return wish->slice == NONE ? STATUS_OK : place_slice(s, err);
}

static enum status acquire(struct vct_show *s, struct gl_device *device, const struct vct_volume_options *options,
			   struct error *err)
{
	struct plan plan = s->plan;
	struct vct_volume_options o = *options;
	if (!vct_show_needs_volume(&plan))
		return voxels_acquire(s->scene, device, &plan, &o.voxels, &s->voxels, err);
	if (in_the_dark(&plan))
		darken(&plan, &o);
	enum status r = vct_volume_acquire(s->scene, device, &plan, &o, &s->volume, err);
	if (r == STATUS_OK)
		s->voxels = s->volume->voxels;
	return r;
}

enum status vct_show_create(struct resident_scene *scene, struct gl_device *device, const struct plan *plan,
			    const struct vct_volume_options *options, struct vct_show **show, struct error *err)
{
	struct vct_show *s = calloc(1, sizeof *s);
	if (!s)
		return error_set(err, STATUS_MEMORY, "out of memory");
	s->plan = *plan;
	s->scene = scene;
	enum status r = acquire(s, device, options, err);
	if (r == STATUS_OK)
		r = vct_show_place(s, err);
	if (r == STATUS_OK)
		*show = s;
	else
		vct_show_destroy(s);
	return r;
}

void vct_show_destroy(struct vct_show *s)
{
	if (!s)
		return;
	if (s->volume)
		vct_volume_release(s->volume);
	else
		voxels_release(s->voxels);
	free(s);
}

enum status vct_show_step(struct vct_show *s, struct gl_timer *timer, uint32_t budget_us, struct error *err)
{
	return s->volume ? vct_volume_step(s->volume, timer, budget_us, err) : voxels_step(s->voxels, timer, budget_us, err);
}

bool vct_show_finished(const struct vct_show *s)
{
	return s->volume ? vct_volume_finished(s->volume) : voxels_finished(s->voxels);
}

double vct_show_fraction(const struct vct_show *s)
{
	return s->volume ? vct_volume_fraction(s->volume) : voxels_fraction(s->voxels);
}

static void vct_show_bind(void *user, const struct deferred_area *area)
{
	const struct vct_show *s = user;
	(void)area;
	voxels_bind(s->voxels);
	if (s->volume) {
		vct_volume_bind(s->volume);
		// The voxels are not there yet when the pass is only compiled.
		if (s->volume->total.name)
			gl_buffer_bind(&s->volume->total, BIND_VCT_TOTAL);
	}
	glUniform4uiv(VCT_SHOW_WHERE, 1, s->where);
	glUniform2uiv(VCT_SHOW_CORNER, 1, s->corner);
}

void vct_show_pass(struct vct_show *s, struct deferred_pass *pass)
{
	*pass = (struct deferred_pass){.source = &show_source, .stage = "show", .bind = vct_show_bind, .user = s};
	gl_define(&pass->defines, "VCT_SHOW", "%u", vct_settings(&s->plan)->show);
	gl_define(&pass->defines, "VCT_SHOW_PYRAMID", "%s", vct_settings(&s->plan)->level > 0 ? "true" : "false");
	if (s->volume)
		vct_define(&pass->defines, &s->volume->options);
}

enum status vct_show_figures(const struct vct_show *s, struct frame *frame, struct error *err)
{
	const uint64_t start = clock_us();
	vct_figures(frame, s->voxels, s->volume, s->scene->blob->origin);
	enum status r = vct_figures_occupied(frame, s->voxels, top_of(s), err);
	frame_add_stage(frame, "count", clock_us() - start);
	return r;
}

uint64_t vct_show_bytes_guess(const struct resident_scene *scene, const struct plan *plan,
			      const struct vct_volume_options *options)
{
	return vct_show_needs_volume(plan) ? vct_volume_bytes_guess(scene, options)
					   : voxels_bytes_guess(scene, &options->voxels);
}
