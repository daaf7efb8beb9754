#include "server/worker/technique/voxel/voxels.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/worker/technique/voxel/voxel_build.h"

static void voxels_destroy(struct shelved *shelved, bool scene_goes)
{
	struct voxels *v = (struct voxels *)shelved;
	(void)scene_goes;
	voxel_build_destroy(v->build, v->device);
	voxel_ranges_finish(&v->ranges);
	gl_buffer_finish(&v->grid_block, v->device);
	gl_buffer_finish(&v->words, v->device);
	gl_buffer_finish(&v->cells, v->device);
	for (unsigned i = 0; i < VOXEL_PARTS; i++)
		gl_buffer_finish(&v->parts[i], v->device);
	free(v);
}

static bool voxels_is_finished(const struct shelved *shelved)
{
	return voxels_finished((const struct voxels *)shelved);
}

static uint64_t voxels_idle_bytes(const struct shelved *shelved)
{
	const struct voxels *v = (const struct voxels *)shelved;
	return voxels_bytes(v) + v->cells.bytes;
}

static const struct shelf_kind kind = {
    .kept = 4, .finished = voxels_is_finished, .bytes = voxels_idle_bytes, .destroy = voxels_destroy};

static uint32_t effects_that_color(const struct plan *plan)
{
	return plan->effects & (1u << candil_Effect_EFFECT_TEXTURES | 1u << candil_Effect_EFFECT_EMITTERS |
				1u << candil_Effect_EFFECT_GLOSSY | 1u << candil_Effect_EFFECT_ALPHA_MASK |
				1u << candil_Effect_EFFECT_VERTEX_COLORS | 1u << candil_Effect_EFFECT_UNLIT |
				1u << candil_Effect_EFFECT_GLASS);
}

// Make the grid over a scene and its base together: it stays the same while things move within the base's bounds.
static struct voxel_grid grid_over(const struct resident_scene *scene, const struct voxel_options *options)
{
	struct voxel_grid grid;
	struct blob_view view = scene->view;
	for (int c = 0; scene->base && c < 3; c++) {
		view.bounds_min[c] = fminf(view.bounds_min[c], scene->base->view.bounds_min[c]);
		view.bounds_max[c] = fmaxf(view.bounds_max[c], scene->base->view.bounds_max[c]);
	}
	voxel_grid_make(&view, options, &grid);
	return grid;
}

static bool same_grid(const struct voxel_grid *a, const struct voxel_grid *b)
{
	return !memcmp(a->low, b->low, sizeof a->low) && !memcmp(&a->side, &b->side, sizeof a->side) &&
	       !memcmp(a->sides, b->sides, sizeof a->sides);
}

// Find voxels like `like` on the shelf. Those being made read the buffers of one variant, and serve its jobs alone.
static struct voxels *voxels_find(const struct shelf *s, const struct voxels *like, const struct resident_scene *scene)
{
	for (struct shelved *at = s->first; at; at = at->next) {
		struct voxels *v = (struct voxels *)at;
		if (v->options.resolution == like->options.resolution && v->options.cube == like->options.cube &&
		    v->effects == like->effects && v->fixed == like->fixed && v->geometry == like->geometry &&
		    v->materials == like->materials && same_grid(&v->grid, &like->grid) &&
		    (!v->fixed || voxel_ranges_equal(&v->ranges, &like->ranges)) && (!v->build || v->build->scene == scene))
			return v;
	}
	return NULL;
}

static enum status acquire_like(struct shelf *shelf, const struct voxels *like, struct resident_scene *scene,
				const struct plan *plan, struct voxels **out, struct error *err);

// Hold the sums of the triangles that an edit leaves in place, if they are enough to be worth it; else none.
static enum status acquire_fixed(const struct voxels *whole, struct resident_scene *scene, const struct plan *plan,
				 struct voxels **out, struct error *err)
{
	struct voxels like = *whole;
	*out = NULL;
	if (!scene->base || whole->fixed || scene->edited.move_count == 0)
		return STATUS_OK;
	struct shelf *shelf = shelf_of(scene, &kind);
	enum status r = shelf ? voxel_ranges_init(&like.ranges, scene, VOXELS_UNMOVED, err)
			      : error_set(err, STATUS_MEMORY, "out of memory");
	like.fixed = true;
	like.geometry = 0;
	if (r == STATUS_OK && like.ranges.triangles > scene_count(scene, BLOB_TRIANGLES) / 2)
		r = acquire_like(shelf, &like, scene, plan, out, err);
	voxel_ranges_finish(&like.ranges);
	return r;
}

static enum status voxels_create(const struct voxels *like, struct resident_scene *scene, const struct plan *plan,
				 bool merge, struct voxels **out, struct error *err)
{
	struct voxels *fixed = NULL, *v = calloc(1, sizeof *v);
	if (!v)
		return error_set(err, STATUS_MEMORY, "out of memory");
	*v = (struct voxels){.device = like->device,
			     .options = like->options,
			     .effects = like->effects,
			     .fixed = like->fixed,
			     .geometry = like->geometry,
			     .materials = like->materials,
			     .grid = like->grid};
	enum status r = v->fixed ? voxel_ranges_init(&v->ranges, scene, VOXELS_UNMOVED, err) : STATUS_OK;
	if (r == STATUS_OK && merge)
		r = acquire_fixed(v, scene, plan, &fixed, err);
	if (r == STATUS_OK)
		r = voxel_build_create(v, scene, plan, fixed, err);
	if (r == STATUS_OK)
		*out = v;
	else
		voxels_destroy(&v->shelved, false);
	return r;
}

static enum status acquire_like(struct shelf *shelf, const struct voxels *like, struct resident_scene *scene,
				const struct plan *plan, struct voxels **out, struct error *err)
{
	struct voxels *v = voxels_find(shelf, like, scene);
	enum status r = STATUS_OK;
	if (!v) {
		r = voxels_create(like, scene, plan, true, &v, err);
		// Where memory is short, first do without merging, then drop what is kept for later jobs.
		while (r == STATUS_MEMORY && (r = voxels_create(like, scene, plan, false, &v, err)) == STATUS_MEMORY &&
		       shelf_drop_idle(shelf, 0))
			;
		if (r != STATUS_OK)
			return r;
		shelf_put(shelf, &v->shelved);
	}
	shelf_hold(&v->shelved);
	*out = v;
	return STATUS_OK;
}

enum status voxels_acquire(struct resident_scene *scene, struct gl_device *device, const struct plan *plan,
			   const struct voxel_options *options, struct voxels **voxels, struct error *err)
{
	struct shelf *s = shelf_of(scene, &kind);
	const struct voxels like = {.device = device,
				    .options = *options,
				    .effects = effects_that_color(plan),
				    .geometry = scene->keys.geometry,
				    .materials = scene->keys.materials,
				    .grid = grid_over(scene, options)};
	return s ? acquire_like(s, &like, scene, plan, voxels, err) : error_set(err, STATUS_MEMORY, "out of memory");
}

void voxels_release(struct voxels *v)
{
	if (v)
		shelf_release(&v->shelved);
}

// Compiling counts as its own stage, by the host's clock; all else by the device's.
static enum status piece(struct voxels *v, struct gl_timer *timer, uint32_t budget_us, struct error *err)
{
	const bool compiles = v->build->phase == VOXEL_COMPILE;
	if (timer && !compiles)
		gl_timer_begin(timer, "voxelise");
	enum status r = voxel_build_piece(v, budget_us, err);
	if (timer && !compiles)
		gl_timer_end(timer);
	if (r == STATUS_OK)
		r = gl_wait(v->device, "voxelising", err);
	if (timer && v->build->compile_us > 0)
		gl_timer_add(timer, "compile", v->build->compile_us);
	v->build->compile_us = 0;
	return r;
}

enum status voxels_step(struct voxels *v, struct gl_timer *timer, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	uint64_t spent = 0;
	enum status r = STATUS_OK;
	while (r == STATUS_OK && v->build && (spent == 0 || spent < budget_us)) {
		r = piece(v, timer, spent < budget_us ? (uint32_t)(budget_us - spent) : 0, err);
		spent = clock_us() - start + 1;
		if (r == STATUS_OK && v->build->phase == VOXEL_DONE) {
			voxel_build_destroy(v->build, v->device);
			v->build = NULL;
		}
	}
	return r;
}

double voxels_fraction(const struct voxels *v)
{
	const struct voxel_build *b = v->build;
	if (!b)
		return 1;
	if (b->phase == VOXEL_COMPILE)
		return 0;
	if (b->phase == VOXEL_FIXED)
		return 0.9 * voxels_fraction(b->fixed);
	const double through = b->ranges.triangles > 0 ? (double)b->stream.done / b->ranges.triangles : 0;
	const double own = b->phase == VOXEL_MARK ? 0.2 * through : b->phase == VOXEL_SUM ? 0.2 + 0.75 * through : 0.95;
	return b->fixed ? 0.9 + 0.1 * own : own;
}

void voxels_bind(const struct voxels *v)
{
	glBindBufferBase(GL_UNIFORM_BUFFER, UNIFORM_VOXEL_GRID, v->grid_block.name);
	gl_buffer_bind(&v->words, BIND_VOXEL_WORDS);
	for (unsigned i = 0; i < VOXEL_PARTS; i++)
		if (v->parts[i].name)
			gl_buffer_bind(&v->parts[i], BIND_VOXEL_PLACE + i);
}

uint64_t voxels_bytes(const struct voxels *v)
{
	uint64_t bytes = v->grid_block.bytes + v->words.bytes;
	for (unsigned i = 0; i < VOXEL_PARTS; i++)
		bytes += v->parts[i].bytes;
	return bytes;
}

uint64_t voxels_bytes_guess(const struct resident_scene *scene, const struct voxel_options *options)
{
	struct voxel_grid grid;
	voxel_grid_make(&scene->view, options, &grid);
	return voxel_grid_bytes(&grid, voxel_entries_guess(&scene->view, &grid)) +
	       VOXEL_ITEMS_CHUNK * sizeof(struct voxel_item);
}
