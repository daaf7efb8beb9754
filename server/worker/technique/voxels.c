#include "server/worker/technique/voxels.h"

#include <epoxy/gl.h>
#include <stdlib.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/worker/technique/voxel_build.h"

#define KEPT 2u // finished voxels that no job uses, of one scene

// All voxels of a scene.
struct shelf {
	struct derived derived;
	struct voxels *first;
	uint64_t turn;
};

static const char kind; // its address names the shelf among the derived

static void destroy(struct voxels *v)
{
	voxel_build_destroy(v->build, v->device);
	gl_buffer_finish(&v->grid_block, v->device);
	gl_buffer_finish(&v->words, v->device);
	for (unsigned i = 0; i < VOXEL_PARTS; i++)
		gl_buffer_finish(&v->parts[i], v->device);
	free(v);
}

static void shelf_destroy(struct derived *derived)
{
	struct shelf *s = (struct shelf *)derived;
	while (s->first) {
		struct voxels *v = s->first;
		s->first = v->next;
		destroy(v);
	}
	free(s);
}

static struct shelf *shelf_of(struct resident_scene *scene)
{
	struct shelf *s = (struct shelf *)resident_derived(scene, &kind);
	if (s)
		return s;
	s = calloc(1, sizeof *s);
	if (s) {
		s->derived = (struct derived){.kind = &kind, .destroy = shelf_destroy};
		resident_derive(scene, &s->derived);
	}
	return s;
}

static void drop(struct shelf *s, struct voxels *v)
{
	struct voxels **at = &s->first;
	while (*at != v)
		at = &(*at)->next;
	*at = v->next;
	destroy(v);
}

// The least recently used of those that nobody uses, if there are more than `kept`. False: there are not.
static bool drop_oldest(struct shelf *s, uint32_t kept)
{
	struct voxels *oldest = NULL;
	uint32_t idle = 0;
	for (struct voxels *v = s->first; v; v = v->next) {
		if (v->users > 0)
			continue;
		idle++;
		oldest = !oldest || v->used < oldest->used ? v : oldest;
	}
	if (idle <= kept)
		return false;
	drop(s, oldest);
	return true;
}

static uint32_t effects_that_color(const struct plan *plan)
{
	return plan->effects & (1u << candil_Effect_EFFECT_TEXTURES | 1u << candil_Effect_EFFECT_EMITTERS |
				1u << candil_Effect_EFFECT_GLOSSY | 1u << candil_Effect_EFFECT_ALPHA_MASK |
				1u << candil_Effect_EFFECT_VERTEX_COLORS | 1u << candil_Effect_EFFECT_UNLIT);
}

static struct voxels *find(const struct shelf *s, const struct voxel_options *options, uint32_t effects)
{
	struct voxels *v = s->first;
	while (v &&
	       !(v->options.resolution == options->resolution && v->options.cube == options->cube && v->effects == effects))
		v = v->next;
	return v;
}

static enum status create(struct resident_scene *scene, struct gl_device *device, const struct plan *plan,
			  const struct voxel_options *options, struct voxels **out, struct error *err)
{
	struct voxels *v = calloc(1, sizeof *v);
	if (!v)
		return error_set(err, STATUS_MEMORY, "out of memory");
	v->device = device;
	v->options = *options;
	v->effects = effects_that_color(plan);
	voxel_grid_make(&scene->view, options, &v->grid);
	const enum status r = voxel_build_create(v, scene, plan, err);
	if (r == STATUS_OK)
		*out = v;
	else
		destroy(v);
	return r;
}

enum status voxels_acquire(struct resident_scene *scene, struct gl_device *device, const struct plan *plan,
			   const struct voxel_options *options, struct voxels **voxels, struct error *err)
{
	struct shelf *s = shelf_of(scene);
	if (!s)
		return error_set(err, STATUS_MEMORY, "out of memory");
	struct voxels *v = find(s, options, effects_that_color(plan));
	enum status r = STATUS_OK;
	if (!v) {
		do
			r = create(scene, device, plan, options, &v, err);
		while (r == STATUS_MEMORY && drop_oldest(s, 0));
		if (r != STATUS_OK)
			return r;
		v->next = s->first;
		s->first = v;
	}
	v->users++;
	v->used = ++s->turn;
	*voxels = v;
	return STATUS_OK;
}

void voxels_release(struct resident_scene *scene, struct voxels *v)
{
	if (!v)
		return;
	struct shelf *s = shelf_of(scene);
	if (--v->users == 0 && v->build)
		drop(s, v);
	while (drop_oldest(s, KEPT))
		;
}

enum status voxels_step(struct voxels *v, struct gl_timer *timer, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	uint64_t spent = 0;
	enum status r = STATUS_OK;
	while (r == STATUS_OK && v->build && (spent == 0 || spent < budget_us)) {
		if (timer)
			gl_timer_begin(timer, "voxelise");
		r = voxel_build_piece(v, spent < budget_us ? (uint32_t)(budget_us - spent) : 0, err);
		if (timer)
			gl_timer_end(timer);
		if (r == STATUS_OK)
			r = gl_wait(v->device, "voxelising", err);
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
	if (!b || b->stream.count == 0)
		return b ? 0 : 1;
	const double through = (double)b->stream.triangle / b->stream.count;
	return b->phase == VOXEL_MARK ? 0.2 * through : b->phase == VOXEL_SUM ? 0.2 + 0.75 * through : 0.95;
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
