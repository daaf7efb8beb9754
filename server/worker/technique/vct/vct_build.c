#include "server/worker/technique/vct/vct_build.h"

#include <epoxy/gl.h>
#include <math.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/worker/gl/scene.h"
#include "server/worker/gl/settle.h"
#include "server/worker/image/frame.h"
#include "server/worker/technique/vct/vct_cones.h"
#include "shaders/gl/vct_bounce_comp.h"
#include "shaders/gl/vct_cells_comp.h"
#include "shaders/gl/vct_gather_comp.h"
#include "shaders/gl/vct_inject_comp.h"
#include "shaders/gl/vct_level_comp.h"
#include "shaders/gl/vct_light_comp.h"

#define FIRST_ITEMS 4096u
#define DISPATCH_ITEMS (65535u * VCT_GROUP)
#define COARSEST_CELLS 8u // along the longest axis, of the coarsest level that cones read: coarser ones blur whole rooms
#define SCALED_MOST 512.0f // the pyramid's radiance where it is largest: half floats hold 128 times as much
#define DIMMEST 1e-34f // W/(m² sr): a smaller maximum is scaled as if it were this, because the factor is a float, too

static const struct gl_source cells_source = {.name = "vct_cells", .compute = source_vct_cells_comp};
static const struct gl_source light_source = {.name = "vct_light", .compute = source_vct_light_comp};
static const struct gl_source inject_source = {.name = "vct_inject", .compute = source_vct_inject_comp};
static const struct gl_source level_source = {.name = "vct_level", .compute = source_vct_level_comp};
static const struct gl_source bounce_source = {.name = "vct_bounce", .compute = source_vct_bounce_comp};
static const struct gl_source gather_source = {.name = "vct_gather", .compute = source_vct_gather_comp};

// ---- the pyramid's shape ------------------------------------------------------------------------------------------------

static void pyramid_sides(const struct voxel_grid *grid, uint32_t sides[3], uint32_t *top)
{
	uint32_t least = UINT32_MAX, most = 0;
	for (int i = 0; i < 3; i++) {
		sides[i] = grid->sides[i] > 1 ? grid->sides[i] / 2 : 1;
		least = sides[i] < least ? sides[i] : least;
		most = sides[i] > most ? sides[i] : most;
	}
	*top = 0;
	while (least >> (*top + 1) > 0 && most >> (*top + 1) >= COARSEST_CELLS && *top + 2 < VCT_LEVELS_MAX)
		++*top;
}

static struct gl_texture_desc pyramid_desc(const struct voxel_grid *grid, bool isotropic)
{
	uint32_t sides[3], top;
	pyramid_sides(grid, sides, &top);
	return (struct gl_texture_desc){.target = GL_TEXTURE_3D,
					.format = GL_RGBA16F,
					.width = (isotropic ? 1 : 6) * sides[0],
					.height = sides[1],
					.depth = sides[2],
					.levels = top + 1};
}

uint64_t vct_pyramid_bytes(const struct voxel_grid *grid, bool isotropic)
{
	const struct gl_texture_desc desc = pyramid_desc(grid, isotropic);
	return gl_texture_bytes(&desc);
}

static void fill_gather(struct vct_params *p)
{
	float cone[VCT_CONES_MAX][4], tangent[VCT_CONES_MAX][4];
	vct_cones_fill(VCT_GATHER_CONES, cone, tangent);
	for (uint32_t i = 0; i < VCT_GATHER_CONES; i++) {
		memcpy(p->gather[i], cone[i], 3 * sizeof(float));
		p->gather[i][3] = tangent[i][0];
	}
}

static void fill_params(struct vct_volume *v)
{
	const struct vct_volume_options *o = &v->options;
	const struct voxel_grid *grid = &v->voxels->grid;
	struct vct_params *p = &v->params;
	memset(p, 0, sizeof *p);
	memcpy(p->low, grid->low, sizeof p->low);
	memcpy(p->background, o->background, sizeof p->background);
	pyramid_sides(grid, p->sides, &p->top);
	p->cell = grid->side * (grid->sides[0] > 1 ? 2.0f : 1.0f);
	p->scale = 1;
	p->cones = o->cones;
	p->rays = o->rays;
	p->marching = o->marching;
	if (!(o->marching.reach > 0))
		p->marching.reach = INFINITY;
	p->emission = o->emission;
	p->sky_turn = o->sky_turn;
	p->sky_scale = o->sky_scale;
	vct_cones_fill(o->cones, p->cone, p->tangent);
	fill_gather(p);
}

static void write_params(struct vct_volume *v)
{
	gl_buffer_write(&v->params_block, 0, sizeof v->params, &v->params);
}

enum status vct_build_begin(struct vct_volume *v, const struct plan *plan, struct error *err)
{
	(void)plan;
	const struct gl_texture_desc desc = pyramid_desc(&v->voxels->grid, v->options.pyramid);
	fill_params(v);
	enum status s = gl_buffer_init(&v->params_block, v->device, sizeof v->params, &v->params, err);
	if (s == STATUS_OK && !v->options.unmarched) {
		s = gl_texture_init(&v->pyramid, v->device, &desc, err);
		if (s == STATUS_OK)
			gl_texture_linear(&v->pyramid, false);
	}
	if (s == STATUS_OK && v->options.volume_shadows == VCT_SHADOWS_VOLUME) {
		struct gl_texture_desc finest = pyramid_desc(&v->voxels->grid, false);
		finest.levels = 1;
		s = gl_texture_init(&v->shares, v->device, &finest, err);
		if (s == STATUS_OK)
			gl_texture_linear(&v->shares, false);
	}
	v->stage = VCT_COMPILE;
	return s;
}

// ---- running a stage ----------------------------------------------------------------------------------------------------

// The program of a stage. NULL: it has none of its own, or this volume does without the stage.
static const struct gl_source *source_of(const struct vct_volume *v, enum vct_stage stage)
{
	switch (stage) {
	case VCT_LIST:
		return &cells_source;
	case VCT_LIGHT:
		return &light_source;
	case VCT_SHARE:
		return v->shares.name ? &inject_source : NULL;
	case VCT_INJECT:
		return v->pyramid.name ? &inject_source : NULL;
	case VCT_LEVELS:
		return v->pyramid.name && v->params.top > 0 ? &level_source : NULL;
	case VCT_GATHER:
		return v->gathers_wanted == 0 ? NULL : v->options.rays ? &bounce_source : &gather_source;
	default:
		return NULL;
	}
}

static enum status program_of(const struct vct_volume *v, enum vct_stage stage, struct gl_program **program,
			      struct error *err)
{
	struct gl_defines defines = {0};
	if (stage == VCT_LIGHT)
		defines = v->light_defines;
	else if (stage == VCT_GATHER && v->options.rays)
		defines = v->ray_defines;
	else if (stage != VCT_LIST)
		defines = v->cone_defines;
	if (stage == VCT_SHARE || stage == VCT_INJECT)
		gl_define(&defines, "VCT_SHARES", "%s", stage == VCT_SHARE ? "true" : "false");
	return gl_program_get(v->device, source_of(v, stage), &defines, program, err);
}

static void bind_images(const struct vct_volume *v, enum vct_stage stage)
{
	if (stage == VCT_SHARE || stage == VCT_INJECT)
		gl_texture_bind_image(stage == VCT_SHARE ? &v->shares : &v->pyramid, VCT_PYRAMID_IMAGE, 0, GL_WRITE_ONLY);
	if (stage == VCT_LEVELS)
		gl_texture_bind_image(&v->pyramid, VCT_PYRAMID_IMAGE, v->level, GL_WRITE_ONLY);
}

// Bind all that the stage's program reads and writes, as far as it is there. The program is in use.
static enum status vct_build_bind(const struct vct_volume *v, enum vct_stage stage, const struct gl_program *program,
				  struct error *err)
{
	const bool traces = stage == VCT_LIGHT || (stage == VCT_GATHER && v->options.rays);
	if (traces)
		gl_settle(v->device);
	gl_program_use(v->device, program);
	if (traces) {
		struct gl_scene *scene;
		enum status s = gl_scene_get(v->scene, v->device, v->bindings, &scene, err);
		if (s != STATUS_OK)
			return s;
		gl_scene_bind(scene, v->bindings);
		gl_buffer_bind(&v->job, BIND_JOB);
	}
	if (stage == VCT_LIGHT) {
		if (v->maps)
			shadow_maps_bind(v->maps);
		glUniform1f(VCT_LEVEL, v->voxels->grid.side);
	}
	voxels_bind(v->voxels);
	glBindBufferBase(GL_UNIFORM_BUFFER, UNIFORM_VCT_PARAMS, v->params_block.name);
	if (v->pyramid.name)
		gl_texture_bind(&v->pyramid, VCT_PYRAMID_UNIT);
	if (v->options.rays)
		vct_landed_bind(&v->landed, v->voxels);
	gl_buffer_bind(v->cells.name ? &v->cells : &v->voxels->cells, BIND_VCT_CELLS);
	gl_buffer_bind(&v->direct, BIND_VCT_DIRECT);
	gl_buffer_bind(&v->total, BIND_VCT_TOTAL);
	if (v->sky)
		sky_map_bind(v->sky);
	bind_images(v, stage);
	return STATUS_OK;
}

static enum status vct_build_use(const struct vct_volume *v, enum vct_stage stage, struct error *err)
{
	struct gl_program *program;
	enum status s = program_of(v, stage, &program, err);
	return s == STATUS_OK ? vct_build_bind(v, stage, program, err) : s;
}

// Run one program over no item, which is when drivers compile.
static enum status warm_up(const struct vct_volume *v, enum vct_stage stage, struct gl_timer *timer, struct error *err)
{
	const uint64_t start = clock_us();
	struct gl_program *program;
	enum status s = program_of(v, stage, &program, err);
	if (s == STATUS_OK)
		s = vct_build_bind(v, stage, program, err);
	bool warm = false;
	if (s == STATUS_OK)
		s = gl_program_ask(v->device, program, &warm, err);
	if (s != STATUS_OK || warm)
		return s;
	glUniform2ui(VCT_RANGE, 0, 0);
	glDispatchCompute(1, 1, 1);
	s = gl_wait(v->device, "compiling", err);
	if (s == STATUS_OK)
		gl_program_has_run(v->device, program);
	if (timer)
		gl_timer_add(timer, FRAME_STAGE_COMPILE, clock_us() - start);
	return s;
}

// Run the program in use over as many of `items` items from next_item on as should fit the budget. *done: none are left.
static enum status run_items(struct vct_volume *v, struct gl_timer *timer, const char *stage, uint64_t items,
			     uint32_t budget_us, bool *done, struct error *err)
{
	const double us = v->item_us[v->stage];
	const uint64_t left = items - v->next_item;
	uint64_t count = us > 0 ? (uint64_t)(budget_us / us) : FIRST_ITEMS;
	count = count < VCT_GROUP ? VCT_GROUP : count;
	count = count > left ? left : count;
	count = count > DISPATCH_ITEMS ? DISPATCH_ITEMS : count;
	const uint64_t start = clock_us();
	if (count > 0) {
		if (timer)
			gl_timer_begin(timer, stage);
		glUniform2ui(VCT_RANGE, (GLuint)v->next_item, (GLuint)count);
		glDispatchCompute((GLuint)((count + VCT_GROUP - 1) / VCT_GROUP), 1, 1);
		glMemoryBarrier(GL_ALL_BARRIER_BITS);
		if (timer)
			gl_timer_end(timer);
	}
	enum status s = gl_wait(v->device, stage, err);
	if (count > 0) {
		const double measured = (double)(clock_us() - start) / (double)count;
		v->item_us[v->stage] = us > 0 ? 0.5 * (us + measured) : measured;
	}
	v->next_item += count;
	*done = v->next_item >= items;
	return s;
}

static void enter(struct vct_volume *v, enum vct_stage stage)
{
	v->stage = stage;
	v->next_item = 0;
}

static uint64_t cells_of_level(const struct vct_params *p, uint32_t level)
{
	uint64_t n = 1;
	for (int i = 0; i < 3; i++)
		n *= p->sides[i] >> level;
	return n;
}

// ---- the stages ---------------------------------------------------------------------------------------------------------

// Bytes of VCT_ENTRY_FLOATS for each entry and of two words: the largest value, and how many ray walks the driver cut short.
static uint64_t irradiance_bytes(uint32_t entries)
{
	return ((uint64_t)entries * VCT_ENTRY_FLOATS + 2) * sizeof(float);
}

// Whether the light stage takes shadows from the pyramid.
static bool marches_for_light(const struct vct_volume *v)
{
	return v->options.volume_shadows == VCT_SHADOWS_MARCH || v->options.volume_shadows == VCT_SHADOWS_CONES;
}

static void enter_lighting(struct vct_volume *v)
{
	// Shadows from the voxels need the voxels' coverage first.
	enter(v, marches_for_light(v) ? VCT_INJECT : VCT_LIGHT);
}

// Compile the programs of one more stage.
static enum status vct_build_compile(struct vct_volume *v, struct gl_timer *timer, struct error *err)
{
	while (v->compiled < VCT_DONE && !source_of(v, (enum vct_stage)v->compiled))
		v->compiled++;
	if (v->compiled == VCT_DONE) {
		enter(v, VCT_VOXELISE);
		return STATUS_OK;
	}
	v->level = v->params.top > 0;
	enum status s = warm_up(v, (enum vct_stage)v->compiled, timer, err);
	if (s == STATUS_OK)
		v->compiled++;
	return s;
}

static enum status voxelise(struct vct_volume *v, struct gl_timer *timer, uint32_t budget_us, struct error *err)
{
	enum status s = voxels_step(v->voxels, timer, budget_us, err);
	if (s != STATUS_OK || !voxels_finished(v->voxels))
		return s;
	const uint64_t entries = v->voxels->grid.entries, bytes = irradiance_bytes(v->voxels->grid.entries);
	s = gl_buffer_init(&v->direct, v->device, bytes, NULL, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&v->total, v->device, bytes, NULL, err);
	if (s == STATUS_OK && v->options.rays && v->gathers_wanted > 0)
		s = gl_buffer_init(&v->sent, v->device, bytes, NULL, err);
	if (s == STATUS_OK && !v->voxels->cells.name)
		s = gl_buffer_init(&v->cells, v->device, (entries + 3) * sizeof(uint32_t), NULL, err);
	if (s != STATUS_OK) {
		// Keep all or none: the call is repeated once others have made room.
		gl_buffer_finish(&v->direct, v->device);
		gl_buffer_finish(&v->total, v->device);
		gl_buffer_finish(&v->sent, v->device);
		return s;
	}
	if (entries == 0)
		enter(v, VCT_DONE);
	else if (v->voxels->cells.name)
		enter_lighting(v);
	else
		enter(v, VCT_LIST);
	return s;
}

// All volumes over these voxels have the same cells, so the first volume gives them to the voxels.
static enum status keep_cells(struct vct_volume *v, struct error *err)
{
	struct voxels *of = v->voxels;
	uint32_t count, areas[2];
	enum status s = gl_buffer_read(&v->cells, v->device, 0, sizeof count, &count, err);
	if (s == STATUS_OK)
		s = gl_buffer_read(&v->cells, v->device, (of->grid.entries + 1ull) * sizeof(uint32_t), sizeof areas, areas,
				   err);
	if (s != STATUS_OK)
		return s;
	if (of->cells.name) {
		gl_buffer_finish(&v->cells, v->device);
		return STATUS_OK;
	}
	of->cells = v->cells;
	of->cell_count = count;
	of->thin = areas[1] > 0 ? (double)areas[0] / areas[1] : 0;
	v->cells = (struct gl_buffer){0};
	return STATUS_OK;
}

static enum status list(struct vct_volume *v, struct gl_timer *timer, uint32_t budget_us, struct error *err)
{
	bool done;
	enum status s = vct_build_use(v, VCT_LIST, err);
	if (s != STATUS_OK)
		return s;
	s = run_items(v, timer, "voxelise", v->voxels->grid.entries, budget_us, &done, err);
	if (s == STATUS_OK && done) {
		s = keep_cells(v, err);
		enter_lighting(v);
	}
	return s;
}

static enum status traversal_cut(struct error *err)
{
	return error_set(err, STATUS_TRAVERSAL_CUT,
			 "one voxel's rays visit more of this scene than the driver lets a loop run: use a GPU or a newer "
			 "driver, or direct.shadows=none");
}

// The largest radiance that a surface reflects is at most its irradiance / π.
static enum status take_scale(struct vct_volume *v, struct error *err)
{
	struct {
		float most;
		uint32_t cut;
	} tail;
	const uint64_t bytes = irradiance_bytes(v->voxels->grid.entries);
	enum status s = gl_buffer_read(&v->direct, v->device, bytes - sizeof tail, sizeof tail, &tail, err);
	if (s != STATUS_OK)
		return s;
	if (tail.cut)
		return traversal_cut(err);
	float most = tail.most * 0.31831f;
	if (v->options.emission && v->emission_most > most)
		most = v->emission_most;
	for (int i = 0; i < 3; i++)
		most = v->options.background[i] > most ? v->options.background[i] : most;
	if (v->sky)
		most = fmaxf(most, v->sky->most * v->options.sky_scale);
	v->params.scale = most > 0 ? SCALED_MOST / fmaxf(most, DIMMEST) : 1;
	write_params(v);
	glCopyNamedBufferSubData(v->direct.name, v->total.name, 0, 0, (GLsizeiptr)bytes);
	return STATUS_OK;
}

static void enter_pyramid(struct vct_volume *v)
{
	enter(v, v->pyramid.name ? VCT_INJECT : VCT_DONE);
}

// Let entries, which have gathered so often, gather by rays once more, over what they have sent so far; if that was often
// enough, let pixels look up the total. A call that fails is repeated, so a gathering counts only once this has worked.
static enum status enter_bounce(struct vct_volume *v, uint32_t gathers, struct error *err)
{
	const uint64_t bytes = irradiance_bytes(v->voxels->grid.entries);
	const bool done = gathers == v->gathers_wanted;
	enum status s = vct_landed_view(&v->landed, v->voxels, done ? &v->total : &v->sent, err);
	if (s != STATUS_OK)
		return s;
	v->gathers = gathers;
	if (done) {
		gl_buffer_finish(&v->sent, v->device);
		enter_pyramid(v);
	} else {
		glCopyNamedBufferSubData(v->total.name, v->sent.name, 0, 0, (GLsizeiptr)bytes);
		enter(v, VCT_GATHER);
	}
	return STATUS_OK;
}

// Direct irradiance enters the pyramid only after light that only cones bring has been gathered once.
static enum status enter_first_pyramid(struct vct_volume *v, struct error *err)
{
	if (v->gathers_first)
		glClearNamedBufferData(v->total.name, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
	if (v->options.rays)
		return enter_bounce(v, 0, err);
	enter(v, VCT_INJECT);
	return STATUS_OK;
}

static enum status light(struct vct_volume *v, struct gl_timer *timer, uint32_t budget_us, struct error *err)
{
	bool done;
	if (v->maps && !shadow_maps_finished(v->maps))
		return shadow_maps_step(v->maps, timer, budget_us, err);
	enum status s = vct_build_use(v, VCT_LIGHT, err);
	if (s != STATUS_OK)
		return s;
	s = run_items(v, timer, "voxel-light", v->voxels->grid.entries, budget_us, &done, err);
	if (s != STATUS_OK || !done)
		return s;
	v->lit = true;
	shadow_maps_release(v->maps);
	v->maps = NULL;
	s = take_scale(v, err);
	if (s != STATUS_OK)
		return s;
	if (!v->shares.name)
		return enter_first_pyramid(v, err);
	enter(v, VCT_SHARE);
	return STATUS_OK;
}

// The stages over the cells of the pyramid's finest level: injection and, where asked for, the shares.
static enum status inject(struct vct_volume *v, struct gl_timer *timer, uint32_t budget_us, struct error *err)
{
	bool done;
	enum status s = vct_build_use(v, (enum vct_stage)v->stage, err);
	if (s != STATUS_OK)
		return s;
	s = run_items(v, timer, "pyramid", 3ull * v->voxels->cell_count, budget_us, &done, err);
	if (s != STATUS_OK || !done)
		return s;
	v->level = 1;
	if (v->stage == VCT_SHARE)
		return enter_first_pyramid(v, err);
	enter(v, VCT_LEVELS);
	return STATUS_OK;
}

static void after_pyramid(struct vct_volume *v)
{
	enter(v, !v->lit ? VCT_LIGHT : v->gathers < v->gathers_wanted ? VCT_GATHER : VCT_DONE);
}

static enum status level(struct vct_volume *v, struct gl_timer *timer, uint32_t budget_us, struct error *err)
{
	bool done;
	if (v->level > v->params.top) {
		after_pyramid(v);
		return STATUS_OK;
	}
	enum status s = vct_build_use(v, VCT_LEVELS, err);
	if (s != STATUS_OK)
		return s;
	glUniform1ui(VCT_LEVEL, v->level);
	s = run_items(v, timer, "pyramid", (v->options.pyramid ? 1 : 6) * cells_of_level(&v->params, v->level), budget_us,
		      &done, err);
	if (s == STATUS_OK && done) {
		v->level++;
		v->next_item = 0;
		if (v->level > v->params.top)
			after_pyramid(v);
	}
	return s;
}

static enum status after_bounce(struct vct_volume *v, struct error *err)
{
	uint32_t cut;
	const uint64_t bytes = irradiance_bytes(v->voxels->grid.entries);
	enum status s = gl_buffer_read(&v->direct, v->device, bytes - sizeof cut, sizeof cut, &cut, err);
	if (s == STATUS_OK && cut)
		s = traversal_cut(err);
	return s == STATUS_OK ? enter_bounce(v, v->gathers + 1, err) : s;
}

static enum status gather(struct vct_volume *v, struct gl_timer *timer, uint32_t budget_us, struct error *err)
{
	bool done;
	enum status s = vct_build_use(v, VCT_GATHER, err);
	if (s != STATUS_OK)
		return s;
	s = run_items(v, timer, "voxel-gather", 2ull * v->voxels->grid.entries, budget_us, &done, err);
	if (s != STATUS_OK || !done)
		return s;
	if (v->options.rays)
		return after_bounce(v, err);
	v->gathers++;
	enter(v, VCT_INJECT);
	return STATUS_OK;
}

enum status vct_build_piece(struct vct_volume *v, struct gl_timer *timer, uint32_t budget_us, struct error *err)
{
	switch ((enum vct_stage)v->stage) {
	case VCT_COMPILE:
		return vct_build_compile(v, timer, err);
	case VCT_VOXELISE:
		return voxelise(v, timer, budget_us, err);
	case VCT_LIST:
		return list(v, timer, budget_us, err);
	case VCT_LIGHT:
		return light(v, timer, budget_us, err);
	case VCT_SHARE:
	case VCT_INJECT:
		return inject(v, timer, budget_us, err);
	case VCT_LEVELS:
		return level(v, timer, budget_us, err);
	case VCT_GATHER:
		return gather(v, timer, budget_us, err);
	case VCT_DONE:
		break;
	}
	return STATUS_OK;
}
