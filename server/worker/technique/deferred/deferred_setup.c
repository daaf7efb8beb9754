// Makes and frees what a deferred job needs on the device.
#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/worker/technique/common/resolve.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/technique/common/scene_traits.h"
#include "server/worker/technique/deferred/deferred_job.h"
#include "shaders/gl/aov_comp.h"
#include "shaders/gl/sum_comp.h"
#include "shaders/gl/visibility_frag.h"
#include "shaders/gl/visibility_vert.h"

#define BAND_BYTES_MAX (128ull << 20) // of a band's sums

static const struct gl_source draw_source = {
    .name = "visibility", .vertex = source_visibility_vert, .fragment = source_visibility_frag};
static const struct gl_source sum_source = {.name = "sum", .compute = source_sum_comp};
static const struct gl_source aov_source = {.name = "deferred-aov", .compute = source_aov_comp};

// Rows of tiles that a band works on. If they are fewer than the image's, one on either side belongs to the next band.
static uint32_t band_tile_rows(const struct gl_device *device, const struct plan *plan, uint32_t rows)
{
	uint64_t most = BAND_BYTES_MAX;
	if (device && device->storage_bytes_max < most)
		most = device->storage_bytes_max;
	const uint64_t fit = most / ((uint64_t)plan->width * TILE_SIDE * ACCUMULATOR_FLOATS * sizeof(float));
	const uint32_t all = tiles_over(plan->height);
	const uint32_t asked = tiles_over(rows) + 2;
	const uint32_t wanted = rows && asked < all ? asked : all;
	return fit < wanted ? (uint32_t)fit : wanted;
}

uint32_t deferred_band_rows(const struct gl_device *device, const struct plan *plan, uint32_t rows)
{
	const uint32_t most = band_tile_rows(device, plan, rows) * TILE_SIDE;
	return most < plan->height ? most : plan->height;
}

uint64_t deferred_bytes(const struct devices *devices, const struct plan *plan, uint32_t rows)
{
	const uint64_t pixels = (uint64_t)plan->width * plan->height;
	const uint64_t texels = (uint64_t)plan->width * deferred_band_rows(devices->gl, plan, rows);
	uint64_t bytes = sizeof(struct scene_params) + sizeof(struct pass_counters), summed = pixels;
	bytes += met_bytes(plan->width, plan->height);
	const uint32_t most = band_tile_rows(devices->gl, plan, rows), all = tiles_over(plan->height);
	if (most > 2 && most < all)
		summed += 2ull * ((all - 1) / (most - 2)) * TILE_SIDE * plan->width; // rows that two bands work on
	bytes += texels * 24; // id, depth, radiance
	bytes += summed * ACCUMULATOR_FLOATS * sizeof(float);
	if (plan->aovs)
		bytes += summed * AOV_WORDS * sizeof(uint32_t);
	return bytes;
}

// ---- bands and buffers --------------------------------------------------------------------------------------------------

// Rows of tiles [first, end).
static struct deferred_rows rows_of(const struct plan *p, uint32_t first, uint32_t end)
{
	const uint32_t low = first * TILE_SIDE, high = end * TILE_SIDE < p->height ? end * TILE_SIDE : p->height;
	return (struct deferred_rows){.first_row = low,
				      .rows = high - low,
				      .first_tile = first * tiles_over(p->width),
				      .tiles = (end - first) * tiles_over(p->width)};
}

static enum status deferred_cut_bands(struct deferred *d, struct error *err)
{
	const struct plan *p = &d->plan;
	const uint32_t fit = band_tile_rows(d->device, p, d->rows), all = tiles_over(p->height);
	if (fit < all && fit < 3)
		return error_set(err, STATUS_MEMORY, "this device cannot bind %u rows of %u pixels: render narrower",
				 3 * TILE_SIDE, p->width);
	const uint32_t most = fit < all ? fit - 2 : all;
	d->band_count = (all + most - 1) / most;
	d->bands = calloc(d->band_count, sizeof *d->bands);
	if (!d->bands)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; i < d->band_count; i++) {
		const uint32_t first = i * most, end = all - first < most ? all : first + most;
		d->bands[i].own = rows_of(p, first, end);
		d->bands[i].outer = rows_of(p, first > 0 ? first - 1 : 0, end < all ? end + 1 : all);
	}
	return STATUS_OK;
}

static enum status deferred_make_buffers(struct deferred *d, struct error *err)
{
	struct scene_params params;
	scene_params_fill(&d->plan, &d->scene->view, false, &params);
	enum status s = gl_buffer_init(&d->job, d->device, sizeof params, &params, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&d->counters, d->device,
				   sizeof(struct pass_counters) + met_bytes(d->plan.width, d->plan.height), NULL, err);
	for (uint32_t i = 0; s == STATUS_OK && i < d->band_count; i++) {
		struct deferred_band *b = &d->bands[i];
		const uint64_t pixels = (uint64_t)b->outer.rows * d->plan.width;
		s = gl_buffer_init(&b->sums, d->device, pixels * ACCUMULATOR_FLOATS * sizeof(float), NULL, err);
		if (s == STATUS_OK && d->plan.aovs)
			s = gl_buffer_init(&b->aov, d->device, pixels * AOV_WORDS * sizeof(uint32_t), NULL, err);
	}
	return s;
}

static enum status make_textures(struct deferred *d, struct error *err)
{
	const struct {
		struct gl_texture *texture;
		GLenum format;
	} all[] = {{&d->visibility, GL_R32UI}, {&d->depth, GL_DEPTH_COMPONENT32F}, {&d->radiance, GL_RGBA32F}};
	enum status s = STATUS_OK;
	for (unsigned i = 0; s == STATUS_OK && i < sizeof all / sizeof *all; i++) {
		const struct gl_texture_desc desc = {.target = GL_TEXTURE_2D,
						     .format = all[i].format,
						     .width = d->plan.width,
						     .height = deferred_band_rows(d->device, &d->plan, d->rows),
						     .depth = 1,
						     .levels = 1};
		s = gl_texture_init(all[i].texture, d->device, &desc, err);
	}
	if (s != STATUS_OK)
		return s;
	glCreateFramebuffers(1, &d->framebuffer);
	glNamedFramebufferTexture(d->framebuffer, GL_COLOR_ATTACHMENT0, d->visibility.name, 0);
	glNamedFramebufferTexture(d->framebuffer, GL_DEPTH_ATTACHMENT, d->depth.name, 0);
	if (glCheckNamedFramebufferStatus(d->framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
		return error_set(err, STATUS_DEVICE, "this OpenGL device cannot draw 32-bit numbers and depths");
	return gl_check(d->device, "making a framebuffer", err);
}

// ---- programs -----------------------------------------------------------------------------------------------------------

static enum status make_program(struct deferred *d, struct deferred_work *work, const struct gl_source *source,
				const struct gl_defines *defines, struct error *err)
{
	struct gl_defines all = {0};
	struct gl_program *program;
	if (defines)
		all = *defines;
	scene_define(&all, d->scene, d->plan.effects);
	const uint64_t start = clock_us();
	enum status s = gl_program_get(d->device, source, &all, &program, err);
	if (s != STATUS_OK)
		return s;
	gl_program_hold(program);
	work->program = program;
	bool cold;
	s = deferred_warm_up(d, work, &cold, err);
	if (cold)
		gl_timer_add(&d->timer, FRAME_STAGE_COMPILE, clock_us() - start);
	return s;
}

// One after the other, those of the AOVs last.
static void make_forecasts(struct deferred *d)
{
	struct forecast *f = d->plan.forecasts ? d->plan.forecasts : d->forecasts;
	for (uint32_t i = 1; i <= d->work_count; i++, f++) {
		struct deferred_work *w = i < d->work_count ? &d->works[i] : &d->aov_work;
		forecast_begin(f, d->band_count * deferred_units_most(d, w));
		w->forecast = f;
	}
}

static enum status make_works(struct deferred *d, struct error *err)
{
	struct deferred_work *w = d->works;
	*w = (struct deferred_work){.kind = DEFERRED_DRAW, .stage = "visibility"};
	enum status s = make_program(d, w++, &draw_source, NULL, err);
	for (uint32_t i = 0; s == STATUS_OK && i < d->pass_count; i++, w++) {
		const struct deferred_pass *p = &d->passes[i];
		*w = (struct deferred_work){.kind = DEFERRED_SHADE, .stage = p->stage, .pass = p};
		s = make_program(d, w, p->source, &p->defines, err);
	}
	if (s != STATUS_OK)
		return s;
	*w = (struct deferred_work){.kind = DEFERRED_SUM, .stage = "sum"};
	s = make_program(d, w++, &sum_source, NULL, err);
	d->work_count = (uint32_t)(w - d->works);
	if (s == STATUS_OK && d->plan.aovs) {
		d->aov_work = (struct deferred_work){.kind = DEFERRED_AOV, .stage = "aov"};
		s = make_program(d, &d->aov_work, &aov_source, NULL, err);
	}
	d->aov_done = !d->plan.aovs;
	make_forecasts(d);
	return s;
}

// ---- the job ------------------------------------------------------------------------------------------------------------

static enum status make_all(struct deferred *d, uint32_t bindings, struct error *err)
{
	const uint64_t start = clock_us();
	d->bindings = bindings | scene_bindings_shade(&d->plan);
	enum status s = gl_scene_get(d->scene, d->device, d->bindings, &d->gl_scene, err);
	if (s == STATUS_OK)
		s = deferred_cut_bands(d, err);
	if (s == STATUS_OK)
		s = deferred_make_buffers(d, err);
	if (s == STATUS_OK)
		s = make_textures(d, err);
	d->upload_us += clock_us() - start;
	return s == STATUS_OK ? make_works(d, err) : s;
}

enum status deferred_create(struct devices *devices, struct resident_scene *scene, const struct plan *plan, uint32_t rows,
			    uint32_t bindings, const struct deferred_pass *passes, uint32_t pass_count,
			    struct deferred **deferred, struct error *err)
{
	struct gl_device *device;
	enum status s = devices_gl(devices, &device, err);
	if (s != STATUS_OK)
		return s;
	struct deferred *d = calloc(1, sizeof *d);
	if (!d)
		return error_set(err, STATUS_MEMORY, "out of memory");
	d->device = device;
	d->scene = scene;
	d->plan = *plan;
	d->rows = rows;
	d->pass_count = pass_count;
	memcpy(d->passes, passes, pass_count * sizeof *passes);
	gl_timer_init(&d->timer);
	gl_timer_add(&d->timer, FRAME_STAGE_COMPILE, 0); // so that it is the first stage that is told
	s = make_all(d, bindings, err);
	if (s != STATUS_OK) {
		deferred_destroy(d);
		return s;
	}
	*deferred = d;
	return STATUS_OK;
}

void deferred_destroy(struct deferred *d)
{
	if (!d)
		return;
	for (uint32_t i = 0; d->bands && i < d->band_count; i++) {
		gl_buffer_finish(&d->bands[i].sums, d->device);
		gl_buffer_finish(&d->bands[i].aov, d->device);
	}
	free(d->bands);
	for (uint32_t i = 0; i < DEFERRED_WORKS; i++)
		gl_program_release(d->works[i].program);
	gl_program_release(d->aov_work.program);
	if (d->framebuffer)
		glDeleteFramebuffers(1, &d->framebuffer);
	gl_texture_finish(&d->visibility, d->device);
	gl_texture_finish(&d->depth, d->device);
	gl_texture_finish(&d->radiance, d->device);
	gl_buffer_finish(&d->job, d->device);
	gl_buffer_finish(&d->counters, d->device);
	gl_timer_finish(&d->timer);
	free(d);
}
