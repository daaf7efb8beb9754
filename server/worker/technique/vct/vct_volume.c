#include "server/worker/technique/vct/vct_volume.h"

#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/technique/common/scene_traits.h"
#include "server/worker/technique/direct/lighting.h"
#include "server/worker/technique/vct/vct_build.h"
#include "server/worker/trace/trace.h"

static void volume_destroy(struct shelved *shelved, bool scene_goes)
{
	struct vct_volume *v = (struct vct_volume *)shelved;
	gl_buffer_finish(&v->params_block, v->device);
	gl_buffer_finish(&v->cells, v->device);
	gl_buffer_finish(&v->direct, v->device);
	gl_buffer_finish(&v->total, v->device);
	gl_buffer_finish(&v->sent, v->device);
	gl_buffer_finish(&v->job, v->device);
	vct_landed_finish(&v->landed);
	gl_texture_finish(&v->pyramid, v->device);
	gl_texture_finish(&v->shares, v->device);
	if (!scene_goes) {
		voxels_release(v->voxels);
		shadow_maps_release(v->maps);
	}
	free(v);
}

static bool volume_is_finished(const struct shelved *shelved)
{
	return vct_volume_finished((const struct vct_volume *)shelved);
}

static uint64_t volume_bytes(const struct vct_volume *v)
{
	return v->params_block.bytes + v->cells.bytes + v->direct.bytes + v->total.bytes + v->sent.bytes + v->job.bytes +
	       v->pyramid.bytes + v->shares.bytes;
}

static bool shares_voxels(const struct shelved *shelved, const struct vct_volume *with)
{
	return shelved->users == 0 && ((const struct vct_volume *)shelved)->voxels == with->voxels;
}

// Device memory of the voxels that freeing an idle volume would free, too. Voxels that only idle volumes hold count for the
// last of these on the shelf, so that they count once.
static uint64_t voxel_share(const struct vct_volume *of)
{
	uint32_t holders = 0;
	bool last = true;
	for (const struct shelved *at = of->shelved.shelf->first; at; at = at->next)
		holders += shares_voxels(at, of);
	for (const struct shelved *at = of->shelved.next; at; at = at->next)
		last = last && !shares_voxels(at, of);
	return last && holders == of->voxels->shelved.users ? voxels_bytes(of->voxels) + of->voxels->cells.bytes : 0;
}

static uint64_t volume_idle_bytes(const struct shelved *shelved)
{
	const struct vct_volume *v = (const struct vct_volume *)shelved;
	return volume_bytes(v) + voxel_share(v);
}

static const struct shelf_kind kind = {
    .kept = 2, .finished = volume_is_finished, .bytes = volume_idle_bytes, .destroy = volume_destroy};

static float brightest(const struct resident_scene *scene)
{
	const struct material *m = scene_section(scene, BLOB_MATERIALS);
	float most = 0;
	for (uint32_t i = 0; i < scene_count(scene, BLOB_MATERIALS); i++)
		for (int c = 0; c < 3; c++)
			most = m[i].emission[c] > most ? m[i].emission[c] : most;
	return most;
}

void vct_define(struct gl_defines *d, const struct vct_volume_options *o)
{
	gl_define(d, "VCT_OWN", "%s", o->own ? "false" : "true");
	gl_define(d, "VCT_SUM", "%s", o->cover ? "false" : "true");
	gl_define(d, "VCT_ISOTROPIC", "%s", o->pyramid ? "true" : "false");
	gl_define(d, "VCT_AMBIENT", "%s", o->marching.ambient > 0 ? "true" : "false");
	if (o->sky)
		gl_define(d, "VCT_SKY", "true");
	if (o->rays) {
		gl_define(d, "VCT_REFLECTS", "%s", o->bounces > 0 ? "true" : "false");
		gl_define(d, "VCT_EMITS", "%s", o->emission ? "true" : "false");
	}
	gl_define(d, "VCT_WEIGHTED", "%s", o->lambert ? "true" : "false");
	if (!vct_shadows_in_volume(o->volume_shadows))
		return;
	gl_define(d, "VCT_SHADOW_HARD", "%s", o->volume_shadows == VCT_SHADOWS_MARCH ? "true" : "false");
	if (o->volume_shadows == VCT_SHADOWS_VOLUME)
		gl_define(d, "VCT_SHADOW_VOLUME", "true");
}

// Two points are a poor sample of many lamps, and the error of an entry shows in every cone that meets it. So an entry takes
// more points of many lamps.
#define LAMPS_MANY 64u
#define POINTS_OF_MANY 16u

static enum status prepare_light(struct vct_volume *v, const struct plan *plan, struct error *err)
{
	struct plan of_light = *plan;
	// The volume outlives the job, so it must not depend on the picture's number of samples.
	of_light.samples = 1;
	struct scene_params job;
	struct lighting_wish wish = {
	    .points = v->options.points, .shadows = v->options.shadows, .map_side = v->options.map_side, .lamps = true};
	if (scene_count(v->scene, BLOB_EMITTERS) > LAMPS_MANY && wish.points < POINTS_OF_MANY)
		wish.points = POINTS_OF_MANY;
	// The volume serves requests of any seed, so it must not depend on the first request's.
	of_light.seed = 0;
	// Entries are diffuse, and have the mesh's own normals.
	of_light.effects &=
	    ~(1u << candil_Effect_EFFECT_GLOSSY | 1u << candil_Effect_EFFECT_NORMAL_MAPS | 1u << candil_Effect_EFFECT_GLASS);
	if (v->options.emission)
		of_light.effects &= ~(1u << candil_Effect_EFFECT_EMITTERS);
	struct plan of_rays = of_light; // they pass through clear surfaces
	of_rays.effects |= plan->effects & 1u << candil_Effect_EFFECT_GLASS;
	v->bindings = scene_bindings_shade(&of_light) | TRACE_BINDINGS;
	if (v->options.rays)
		v->bindings |= scene_bindings_shade(&of_rays);
	v->emission_most = brightest(v->scene);
	scene_define(&v->light_defines, v->scene, of_light.effects);
	lighting_define(&v->light_defines, &of_light, v->scene, &wish);
	vct_define(&v->light_defines, &v->options);
	// The ambient term is added at pixels only, so it takes no part in bounces.
	struct vct_volume_options of_bounces = v->options;
	of_bounces.marching.ambient = 0;
	vct_define(&v->cone_defines, &of_bounces);
	if (!v->options.rays)
		gl_define(&v->cone_defines, "VCT_REFLECTS", "%s", v->options.bounces > 0 ? "true" : "false");
	scene_define(&v->ray_defines, v->scene, of_rays.effects);
	vct_define(&v->ray_defines, &of_bounces);
	scene_params_fill(&of_light, &v->scene->view, false, &job);
	return gl_buffer_init(&v->job, v->device, sizeof job, &job, err);
}

// Whether some light comes by cones alone: that of the background, and of emission that is in the pyramid, is not in
// `direct`.
static bool sends_by_cones(const struct vct_volume_options *o)
{
	return o->emission || o->sky || o->background[0] > 0 || o->background[1] > 0 || o->background[2] > 0;
}

static enum status volume_create(struct resident_scene *scene, struct gl_device *device, const struct plan *plan,
				 const struct vct_volume_options *options, struct vct_volume **out, struct error *err)
{
	struct vct_volume *v = calloc(1, sizeof *v);
	if (!v)
		return error_set(err, STATUS_MEMORY, "out of memory");
	v->options = *options;
	v->device = device;
	v->scene = scene;
	v->keys = scene->keys;
	v->gathers_wanted = options->bounces > 0 ? options->bounces - 1 : 0;
	v->gathers_first = options->bounces > 0 && sends_by_cones(options);
	if (v->gathers_first)
		v->gathers_wanted++;
	enum status s = voxels_acquire(scene, device, plan, &options->voxels, &v->voxels, err);
	if (s == STATUS_OK)
		s = vct_build_begin(v, plan, err);
	if (s == STATUS_OK)
		s = prepare_light(v, plan, err);
	uint64_t compile_us = 0; // not reported here: the picture's lighting uses the same maps, and reports it
	if (s == STATUS_OK && shadow_maps_wanted(plan, scene, options->map_side))
		s = shadow_maps_acquire(scene, device, plan, options->map_side, &compile_us, &v->maps, err);
	if (s == STATUS_OK && options->rays)
		s = vct_landed_init(&v->landed, device, &v->voxels->grid, err);
	if (s == STATUS_OK)
		*out = v;
	else
		volume_destroy(&v->shelved, false);
	return s;
}

// Find a volume on the shelf. One that is being made reads the buffers of one variant, and serves its jobs alone.
static struct vct_volume *volume_find(const struct shelf *s, const struct resident_scene *scene,
				      const struct vct_volume_options *options)
{
	for (struct shelved *at = s->first; at; at = at->next) {
		struct vct_volume *v = (struct vct_volume *)at;
		if (!memcmp(&v->options, options, sizeof *options) && !memcmp(&v->keys, &scene->keys, sizeof v->keys) &&
		    (vct_volume_finished(v) || v->scene == scene))
			return v;
	}
	return NULL;
}

enum status vct_volume_acquire(struct resident_scene *scene, struct gl_device *device, const struct plan *plan,
			       const struct vct_volume_options *options, struct vct_volume **volume, struct error *err)
{
	struct shelf *shelf = shelf_of(scene, &kind);
	enum status s = STATUS_OK;
	const struct sky_map *sky = NULL;
	const struct sky_table *table = NULL;
	if (!shelf)
		return error_set(err, STATUS_MEMORY, "out of memory");
	if (options->sky)
		s = sky_map_get(plan->environment.scene, device, &sky, err);
	if (s == STATUS_OK && options->sky && options->rays)
		s = sky_table_get(plan->environment.scene, device, &table, err);
	if (s != STATUS_OK)
		return s;
	struct vct_volume *v = volume_find(shelf, scene, options);
	if (!v) {
		while (shelf_drop_idle(shelf, kind.kept - 1))
			;
		do
			s = volume_create(scene, device, plan, options, &v, err);
		while (s == STATUS_MEMORY && shelf_drop_idle(shelf, 0));
		if (s != STATUS_OK)
			return s;
		shelf_put(shelf, &v->shelved);
	}
	v->sky = sky;
	v->landed.sky = table;
	shelf_hold(&v->shelved);
	*volume = v;
	return STATUS_OK;
}

void vct_volume_release(struct vct_volume *v)
{
	if (v)
		shelf_release(&v->shelved);
}

enum status vct_volume_step(struct vct_volume *v, struct gl_timer *timer, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	uint64_t spent = 0;
	enum status s = STATUS_OK;
	do {
		s = vct_build_piece(v, timer, budget_us - (uint32_t)spent, err);
		spent = clock_us() - start;
	} while (s == STATUS_OK && !vct_volume_finished(v) && spent < budget_us);
	return s;
}

bool vct_volume_finished(const struct vct_volume *v)
{
	return v->stage == VCT_DONE;
}

double vct_volume_fraction(const struct vct_volume *v)
{
	if (vct_volume_finished(v))
		return 1;
	if (v->stage == VCT_COMPILE)
		return 0;
	if (v->stage == VCT_VOXELISE)
		return 0.4 * voxels_fraction(v->voxels);
	const double entries = v->voxels->grid.entries;
	const double rounds = v->gathers_wanted + 1.0;
	const double items = v->stage == VCT_LIGHT ? entries : v->stage == VCT_GATHER ? 2 * entries : 1e300;
	return 0.4 + 0.6 * (v->gathers + (double)v->next_item / items) / rounds;
}

void vct_volume_bind(const struct vct_volume *v)
{
	glBindBufferBase(GL_UNIFORM_BUFFER, UNIFORM_VCT_PARAMS, v->params_block.name);
	if (v->pyramid.name)
		gl_texture_bind(&v->pyramid, VCT_PYRAMID_UNIT);
	if (v->shares.name)
		gl_texture_bind(&v->shares, VCT_SHARES_UNIT);
	if (v->sky)
		sky_map_bind(v->sky);
	if (v->options.rays)
		vct_landed_bind(&v->landed, v->voxels);
}

uint64_t vct_volume_bytes_guess(const struct resident_scene *scene, const struct vct_volume_options *options)
{
	struct voxel_grid grid;
	voxel_grid_make(&scene->view, &options->voxels, &grid);
	const uint64_t entries = voxel_entries_guess(&scene->view, &grid);
	const uint64_t pyramid = options->unmarched ? 0 : vct_pyramid_bytes(&grid, options->pyramid);
	return voxels_bytes_guess(scene, &options->voxels) + pyramid +
	       (options->rays ? 3 : 2) * entries * VCT_ENTRY_FLOATS * sizeof(float);
}
