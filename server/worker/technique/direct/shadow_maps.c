#include "server/worker/technique/direct/shadow_maps.h"

#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/worker/gl/scene.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/technique/common/scene_traits.h"
#include "server/worker/technique/direct/shadow_views.h"
#include "shaders/gl/shadow_frag.h"
#include "shaders/gl/shadow_vert.h"
#include "shaders/shared/deferred.h"

#define FIRST_TRIANGLES 512u // one may cover all of a map
#define GROWTH 4u // a piece has at most so many times the triangles of the piece before

static const struct gl_source whole_source = {.name = "shadow", .vertex = source_shadow_vert};
static const struct gl_source cut_source = {
    .name = "shadow-cut", .vertex = source_shadow_vert, .fragment = source_shadow_frag};

// ---- what is kept -------------------------------------------------------------------------------------------------------

// Free what only drawing needs.
static void finish_drawing(struct shadow_maps *m)
{
	for (unsigned i = 0; i < 2; i++) {
		gl_program_release(m->programs[i]);
		m->programs[i] = NULL;
	}
	gl_buffer_finish(&m->job, m->device);
	if (m->framebuffer)
		glDeleteFramebuffers(1, &m->framebuffer);
	m->framebuffer = 0;
	m->scene = NULL;
}

static void shadow_maps_destroy(struct shelved *shelved, bool scene_goes)
{
	struct shadow_maps *m = (struct shadow_maps *)shelved;
	(void)scene_goes;
	finish_drawing(m);
	gl_texture_finish(&m->depths, m->device);
	gl_buffer_finish(&m->views, m->device);
	gl_buffer_finish(&m->lights, m->device);
	free(m);
}

static bool shadow_maps_is_finished(const struct shelved *shelved)
{
	return shadow_maps_finished((const struct shadow_maps *)shelved);
}

static uint64_t shadow_maps_idle_bytes(const struct shelved *shelved)
{
	const struct shadow_maps *m = (const struct shadow_maps *)shelved;
	return m->depths.bytes + m->views.bytes + m->lights.bytes;
}

static const struct shelf_kind kind = {
    .kept = 2, .finished = shadow_maps_is_finished, .bytes = shadow_maps_idle_bytes, .destroy = shadow_maps_destroy};

// ---- what a plan wants --------------------------------------------------------------------------------------------------

bool shadow_maps_wanted(const struct plan *plan, const struct resident_scene *scene, uint32_t side)
{
	return side > 0 && plan_has(plan, candil_Effect_EFFECT_LIGHTS) && scene_count(scene, BLOB_LIGHTS) > 0;
}

bool shadow_maps_for_all(const struct resident_scene *scene)
{
	return scene_count(scene, BLOB_LIGHTS) <= SHADOW_LIGHTS_MAX;
}

static bool is_cut(const struct plan *plan)
{
	return plan_has(plan, candil_Effect_EFFECT_ALPHA_MASK) || plan_has(plan, candil_Effect_EFFECT_ALPHA_BLEND);
}

static struct shadow_key key_of(const struct plan *plan, const struct resident_scene *scene, uint32_t side)
{
	const uint32_t cut = 1u << candil_Effect_EFFECT_ALPHA_MASK | 1u << candil_Effect_EFFECT_ALPHA_BLEND |
			     1u << candil_Effect_EFFECT_TEXTURES | 1u << candil_Effect_EFFECT_VERTEX_COLORS;
	return (struct shadow_key){.geometry = scene->keys.geometry,
				   .lights = scene->keys.lights,
				   .materials = is_cut(plan) ? scene->keys.materials : 0,
				   .effects = is_cut(plan) ? plan->effects & cut : 0,
				   .side = side};
}

static struct gl_texture_desc depths_desc(uint32_t side, uint32_t count)
{
	return (struct gl_texture_desc){.target = GL_TEXTURE_2D_ARRAY,
					.format = GL_DEPTH_COMPONENT32F,
					.width = side,
					.height = side,
					.depth = count,
					.levels = 1};
}

uint64_t shadow_maps_bytes(const struct plan *plan, const struct resident_scene *scene, uint32_t side)
{
	if (!shadow_maps_wanted(plan, scene, side))
		return 0;
	const struct gl_texture_desc desc = depths_desc(side, shadow_views_count(&scene->view));
	return gl_texture_bytes(&desc) + SHADOW_MAPS_MAX * sizeof(struct shadow_map) +
	       scene_count(scene, BLOB_LIGHTS) * sizeof(uint32_t);
}

// ---- making -------------------------------------------------------------------------------------------------------------

static enum status shadow_maps_make_buffers(struct shadow_maps *m, const struct plan *plan, struct error *err)
{
	struct shadow_views views;
	struct scene_params job;
	enum status s = shadow_views_init(&views, &m->scene->view, m->key.side, err);
	scene_params_fill(plan, &m->scene->view, false, &job);
	m->count = views.count;
	const struct gl_texture_desc desc = depths_desc(m->key.side, m->count);
	if (s == STATUS_OK)
		s = gl_texture_init(&m->depths, m->device, &desc, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&m->views, m->device, sizeof views.maps, views.maps, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&m->lights, m->device, scene_count(m->scene, BLOB_LIGHTS) * sizeof *views.first,
				   views.first, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&m->job, m->device, sizeof job, &job, err);
	shadow_views_finish(&views);
	return s;
}

static enum status make_framebuffer(struct shadow_maps *m, struct error *err)
{
	glCreateFramebuffers(1, &m->framebuffer);
	glNamedFramebufferTextureLayer(m->framebuffer, GL_DEPTH_ATTACHMENT, m->depths.name, 0, 0);
	glNamedFramebufferDrawBuffer(m->framebuffer, GL_NONE);
	glNamedFramebufferReadBuffer(m->framebuffer, GL_NONE);
	if (glCheckNamedFramebufferStatus(m->framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
		return error_set(err, STATUS_DEVICE, "this OpenGL device cannot draw shadow maps");
	return gl_check(m->device, "making a framebuffer", err);
}

static void shadow_maps_set_raster(const struct shadow_maps *m)
{
	glBindFramebuffer(GL_FRAMEBUFFER, m->framebuffer);
	glViewport(0, 0, (GLsizei)m->key.side, (GLsizei)m->key.side);
	glBindVertexArray(m->device->vertex_array);
}

static bool has_holes(const struct shadow_maps *m, uint32_t triangle)
{
	const struct triangle *triangles = scene_section(m->scene, BLOB_TRIANGLES);
	const struct material *materials = scene_section(m->scene, BLOB_MATERIALS);
	return m->programs[1] &&
	       materials[triangles[triangle].material].flags & (MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND);
}

// Draw a run of triangles that all have holes (`cut`), or all have none: whole ones are drawn several times as fast.
static void draw_run(const struct shadow_maps *m, uint32_t first, uint32_t end, bool cut)
{
	glUseProgram(m->programs[cut]->name);
	glUniform1ui(SHADOW_LAYER, m->layer);
	if (cut)
		glUniform1ui(DEFERRED_TRIANGLE, first);
	glDrawArrays(GL_TRIANGLES, (GLint)(3 * first), (GLsizei)(3 * (end - first)));
}

// Draw `count` triangles into the current map, from the next triangle on.
static enum status draw(const struct shadow_maps *m, uint32_t count, struct error *err)
{
	const uint32_t end = m->triangle + count;
	const GLfloat nothing = 0.0f;
	struct gl_scene *scene;
	enum status s = gl_scene_get(m->scene, m->device, m->bindings, &scene, err);
	if (s != STATUS_OK)
		return s;
	gl_scene_bind(scene, m->bindings);
	gl_buffer_bind(&m->job, BIND_JOB);
	glBindBufferBase(GL_UNIFORM_BUFFER, UNIFORM_SHADOW_MAPS, m->views.name);
	glNamedFramebufferTextureLayer(m->framebuffer, GL_DEPTH_ATTACHMENT, m->depths.name, 0, (GLint)m->layer);
	shadow_maps_set_raster(m);
	if (m->triangle == 0)
		glClearBufferfv(GL_DEPTH, 0, &nothing);
	for (uint32_t at = m->triangle, next; at < end; at = next) {
		const bool cut = has_holes(m, at);
		next = at + 1;
		while (next < end && has_holes(m, next) == cut)
			next++;
		draw_run(m, at, next, cut);
	}
	glBindFramebuffer(GL_FRAMEBUFFER, 0);
	glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
	return STATUS_OK;
}

static enum status make_programs(struct shadow_maps *m, const struct plan *plan, uint64_t *compile_us, struct error *err)
{
	const uint64_t start = clock_us();
	bool all_warm = true;
	for (unsigned i = 0; i < (is_cut(plan) ? 2 : 1); i++) {
		struct gl_defines defines = {0};
		struct gl_program *program;
		if (i == 1)
			scene_define(&defines, m->scene, m->key.effects);
		enum status s = gl_program_get(m->device, i ? &cut_source : &whole_source, &defines, &program, err);
		if (s != STATUS_OK)
			return s;
		gl_program_hold(program);
		m->programs[i] = program;
		gl_program_use(m->device, program);
		bool warm;
		s = gl_program_ask(m->device, program, &warm, err);
		if (s != STATUS_OK)
			return s;
		all_warm &= warm;
	}
	if (all_warm || scene_count(m->scene, BLOB_TRIANGLES) == 0)
		return STATUS_OK;
	// Make the driver compile: draw the first triangle, whatever it is, by both programs. It is drawn again at its turn.
	enum status s = draw(m, 1, err);
	if (s == STATUS_OK && m->programs[1]) {
		glBindFramebuffer(GL_FRAMEBUFFER, m->framebuffer);
		draw_run(m, 0, 1, true);
		glBindFramebuffer(GL_FRAMEBUFFER, 0);
	}
	if (s == STATUS_OK)
		s = gl_wait(m->device, "shadow-maps", err);
	for (unsigned i = 0; s == STATUS_OK && i < 2 && m->programs[i]; i++) {
		gl_program_use(m->device, m->programs[i]);
		gl_program_has_run(m->device, m->programs[i]);
	}
	*compile_us += clock_us() - start;
	return s;
}

static enum status shadow_maps_create(struct resident_scene *scene, struct gl_device *device, const struct plan *plan,
				      const struct shadow_key *key, uint64_t *compile_us, struct shadow_maps **out,
				      struct error *err)
{
	struct shadow_maps *m = calloc(1, sizeof *m);
	if (!m)
		return error_set(err, STATUS_MEMORY, "out of memory");
	m->device = device;
	m->scene = scene;
	m->key = *key;
	m->bindings = scene_bindings_shade(plan);
	enum status s = shadow_maps_make_buffers(m, plan, err);
	if (s == STATUS_OK)
		s = make_framebuffer(m, err);
	if (s == STATUS_OK)
		s = make_programs(m, plan, compile_us, err);
	if (s == STATUS_OK)
		*out = m;
	else
		shadow_maps_destroy(&m->shelved, false);
	return s;
}

// Find the maps on the shelf. Maps that are being drawn read their scene, so they serve jobs of that scene alone.
static struct shadow_maps *shadow_maps_find(const struct shelf *s, const struct shadow_key *key,
					    const struct resident_scene *scene)
{
	for (struct shelved *at = s->first; at; at = at->next) {
		struct shadow_maps *m = (struct shadow_maps *)at;
		if (!memcmp(&m->key, key, sizeof *key) && (!m->scene || m->scene == scene))
			return m;
	}
	return NULL;
}

enum status shadow_maps_acquire(struct resident_scene *scene, struct gl_device *device, const struct plan *plan,
				uint32_t side, uint64_t *compile_us, struct shadow_maps **maps, struct error *err)
{
	const struct shadow_key key = key_of(plan, scene, side);
	struct shelf *shelf = shelf_of(scene, &kind);
	if (!shelf)
		return error_set(err, STATUS_MEMORY, "out of memory");
	struct shadow_maps *m = shadow_maps_find(shelf, &key, scene);
	if (!m) {
		enum status s = shadow_maps_create(scene, device, plan, &key, compile_us, &m, err);
		while (s == STATUS_MEMORY && shelf_drop_idle(shelf, 0))
			s = shadow_maps_create(scene, device, plan, &key, compile_us, &m, err);
		if (s != STATUS_OK)
			return s;
		shelf_put(shelf, &m->shelved);
	}
	shelf_hold(&m->shelved);
	*maps = m;
	return STATUS_OK;
}

void shadow_maps_release(struct shadow_maps *m)
{
	if (m)
		shelf_release(&m->shelved);
}

// ---- drawing ------------------------------------------------------------------------------------------------------------

static uint32_t affordable(const struct shadow_maps *m, double us)
{
	const uint32_t left = scene_count(m->scene, BLOB_TRIANGLES) - m->triangle;
	const double most = m->last > 0 ? (double)GROWTH * m->last : FIRST_TRIANGLES;
	const double wanted = m->triangle_us > 0 ? us / m->triangle_us : FIRST_TRIANGLES;
	const double n = wanted < most ? wanted : most;
	return n < 1 ? left > 0 : n < left ? (uint32_t)n : left;
}

static enum status draw_piece(struct shadow_maps *m, struct gl_timer *timer, double us, struct error *err)
{
	const uint32_t count = affordable(m, us);
	const uint64_t start = clock_us();
	gl_timer_begin(timer, "shadow-maps");
	// Without it, software drivers take the time stamp only when they fill pixels, after all vertices are transformed.
	glFlush();
	enum status s = draw(m, count, err);
	gl_timer_end(timer);
	if (s == STATUS_OK)
		s = gl_wait(m->device, "shadow-maps", err);
	if (s != STATUS_OK)
		return s;
	if (count > 0) {
		const double measured = (double)(clock_us() - start) / count;
		m->triangle_us = m->triangle_us > 0 ? 0.5 * (m->triangle_us + measured) : measured;
		m->last = count;
	}
	m->triangle += count;
	if (m->triangle < scene_count(m->scene, BLOB_TRIANGLES))
		return STATUS_OK;
	m->triangle = 0;
	if (++m->layer == m->count)
		finish_drawing(m);
	return STATUS_OK;
}

enum status shadow_maps_step(struct shadow_maps *m, struct gl_timer *timer, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	uint64_t spent = 0;
	enum status s = STATUS_OK;
	while (s == STATUS_OK && !shadow_maps_finished(m) && (spent == 0 || spent < budget_us)) {
		s = draw_piece(m, timer, (double)(budget_us > spent ? budget_us - spent : 0), err);
		spent = clock_us() - start + 1;
	}
	return s;
}

void shadow_maps_bind(const struct shadow_maps *m)
{
	gl_texture_bind(&m->depths, SHADOW_MAPS_UNIT);
	glBindBufferBase(GL_UNIFORM_BUFFER, UNIFORM_SHADOW_MAPS, m->views.name);
	gl_buffer_bind(&m->lights, BIND_SHADOW_LIGHTS);
}
