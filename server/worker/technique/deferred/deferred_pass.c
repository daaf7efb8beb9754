// One piece of one pass. It binds all that it needs, because other jobs use the device between two slices.
#include <epoxy/gl.h>

#include "server/worker/gl/settle.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/technique/deferred/deferred_job.h"
#include "shaders/shared/deferred.h"

#define TILES_PER_DISPATCH 65535u

uint32_t deferred_units(const struct deferred *d, const struct deferred_work *work, uint32_t band)
{
	const struct deferred_band *b = &d->bands[band];
	if (work->kind == DEFERRED_DRAW)
		return scene_count(d->scene, BLOB_TRIANGLES);
	if (work->kind == DEFERRED_SHADE && work->pass->halved)
		return tiles_over((d->plan.width + 1) / 2) * tiles_over((b->outer.rows + 1) / 2);
	return work->kind == DEFERRED_SHADE ? b->outer.tiles : b->own.tiles;
}

// Inner bands are as large as each other, and the last one is no larger.
uint32_t deferred_units_most(const struct deferred *d, const struct deferred_work *work)
{
	const uint32_t outer = deferred_units(d, work, 0), inner = deferred_units(d, work, d->band_count > 1);
	return outer > inner ? outer : inner;
}

struct deferred_work *deferred_current(struct deferred *d)
{
	return !d->aov_done && d->work == 1 ? &d->aov_work : &d->works[d->work];
}

static uint32_t reversed(uint32_t x)
{
	uint32_t r = 0;
	for (int i = 0; i < 32; i++)
		r |= (x >> i & 1u) << (31 - i);
	return r;
}

// lowbias32, as in common/sampling.glsl.
static uint32_t hash(uint32_t x)
{
	x ^= x >> 16;
	x *= 0x7feb352du;
	x ^= x >> 15;
	x *= 0x846ca68bu;
	return x ^ x >> 16;
}

// The second dimension of Sobol's sequence (1967). Its direction numbers are Pascal's triangle modulo 2: each is the one
// before times 1 + x.
static uint32_t sobol1(uint32_t i)
{
	uint32_t r = 0;
	for (uint32_t v = 1u << 31; i; i >>= 1, v ^= v >> 1)
		if (i & 1u)
			r ^= v;
	return r;
}

// Where in the pixel a sample's rays go: through the middle if it is the only sample, else by a (0, 2)-sequence that is
// scrambled (digit by digit, by XOR) for each half of the samples on its own.
static void jitter(const struct deferred *d, uint32_t half, uint32_t index, float out[2])
{
	const struct plan *p = &d->plan;
	if (!d->aov_done || (p->samples == 1 && p->first_sample == 0)) {
		out[0] = out[1] = 0.5f;
		return;
	}
	const uint32_t h = hash(hash((uint32_t)p->seed) ^ (uint32_t)(p->seed >> 32)) + half;
	const uint32_t x = reversed(index) ^ hash(h ^ 0x68bc21ebu), y = sobol1(index) ^ hash(h ^ 0x02e5be93u);
	out[0] = (float)(x >> 8) * 0x1p-24f;
	out[1] = (float)(y >> 8) * 0x1p-24f;
}

// `first_tile` counts the image's tiles.
static void set_uniforms(const struct deferred *d, uint32_t first_tile, uint32_t tiles)
{
	const struct deferred_rows *r = &d->bands[d->band].outer;
	const uint32_t global = d->plan.first_sample + d->sample;
	float at[2];
	jitter(d, global & 1u, global >> 1, at);
	glUniform4ui(DEFERRED_AREA, r->first_row, r->rows, first_tile, tiles);
	glUniform4ui(DEFERRED_SAMPLE, global & 1u, global >> 1, d->sample, d->plan.width);
	glUniform2fv(DEFERRED_JITTER, 1, at);
}

static void bind_common(const struct deferred *d, const struct gl_program *program)
{
	gl_program_use(d->device, program);
	gl_scene_bind(d->gl_scene, d->bindings);
	gl_buffer_bind(&d->job, BIND_JOB);
}

static void deferred_set_raster(const struct deferred *d)
{
	const struct deferred_band *b = &d->bands[d->band];
	glBindFramebuffer(GL_FRAMEBUFFER, d->framebuffer);
	glViewport(0, -(GLint)b->outer.first_row, (GLsizei)d->plan.width, (GLsizei)d->plan.height);
	glBindVertexArray(d->device->vertex_array);
}

// The sum pass clears the radiance that it takes. Of the outer rows, which it does not take, some may be left.
static void clear_radiance(const struct deferred *d)
{
	if (d->band_count == 1)
		return;
	glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
	glClearTexImage(d->radiance.name, 0, GL_RGBA, GL_FLOAT, NULL);
}

static void bind_draw(const struct deferred *d, const struct gl_program *program)
{
	bind_common(d, program);
	gl_scene_bind_corners(d->gl_scene);
}

static void record_draw(const struct deferred *d, const struct deferred_work *work, uint32_t first, uint32_t count)
{
	const GLuint nothing[4] = {0};
	const GLfloat far = 0.0f;
	bind_draw(d, work->program);
	deferred_set_raster(d);
	if (first == 0) {
		glClearBufferuiv(GL_COLOR, 0, nothing);
		glClearBufferfv(GL_DEPTH, 0, &far);
		clear_radiance(d);
	}
	set_uniforms(d, 0, 0);
	glUniform1ui(DEFERRED_TRIANGLE, first);
	if (count > 0)
		glDrawArrays(GL_TRIANGLES, (GLint)(3 * first), (GLsizei)(3 * count));
	glBindFramebuffer(GL_FRAMEBUFFER, 0);
	glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

static void record_tiles(const struct deferred *d, const struct deferred_work *work, uint32_t first, uint32_t count)
{
	const struct deferred_band *b = &d->bands[d->band];
	const struct deferred_area area = {
	    .width = d->plan.width, .first_row = b->outer.first_row, .rows = b->outer.rows, .sample = d->sample};
	if (work->kind == DEFERRED_SHADE)
		gl_settle(d->device);
	bind_common(d, work->program);
	gl_texture_bind(&d->visibility, DEFERRED_VISIBILITY_UNIT);
	gl_texture_bind_image(&d->radiance, DEFERRED_RADIANCE_UNIT, 0, GL_READ_WRITE);
	if (work->kind == DEFERRED_SUM) {
		gl_buffer_bind(&d->counters, BIND_COUNTERS);
		gl_buffer_bind(&b->sums, BIND_ACCUMULATOR);
	} else if (work->kind == DEFERRED_AOV) {
		gl_buffer_bind(&b->aov, BIND_AOV);
	} else if (work->pass->bind) {
		work->pass->bind(work->pass->user, &area);
	}
	first += work->kind == DEFERRED_SHADE ? b->outer.first_tile : b->own.first_tile;
	while (count > 0) {
		const uint32_t n = count < TILES_PER_DISPATCH ? count : TILES_PER_DISPATCH;
		set_uniforms(d, first, n);
		glDispatchCompute(n, 1, 1);
		first += n;
		count -= n;
	}
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
			GL_BUFFER_UPDATE_BARRIER_BIT);
}

void deferred_record(struct deferred *d, uint32_t count)
{
	const struct deferred_work *work = deferred_current(d);
	gl_timer_begin(&d->timer, work->stage);
	if (work->kind == DEFERRED_DRAW)
		record_draw(d, work, d->unit, count);
	else
		record_tiles(d, work, d->unit, count);
	gl_timer_end(&d->timer);
}

enum status deferred_warm_up(struct deferred *d, struct deferred_work *work, bool *cold, struct error *err)
{
	if (work->kind == DEFERRED_DRAW)
		bind_draw(d, work->program);
	else
		record_tiles(d, work, 0, 0);
	bool warm;
	enum status s = gl_program_ask(d->device, work->program, &warm, err);
	*cold = !warm;
	if (warm || s != STATUS_OK)
		return s;
	if (work->kind == DEFERRED_DRAW) {
		record_draw(d, work, 0, scene_count(d->scene, BLOB_TRIANGLES) > 0);
	} else {
		set_uniforms(d, 0, 0);
		glDispatchCompute(1, 1, 1);
	}
	s = gl_wait(d->device, work->stage, err);
	if (s == STATUS_OK)
		gl_program_has_run(d->device, work->program);
	return s;
}
