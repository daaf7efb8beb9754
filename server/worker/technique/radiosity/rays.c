#include "server/worker/technique/radiosity/rays.h"

#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/vec3.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/technique/common/scene_traits.h"
#include "server/worker/vk/command.h"
#include "shaders/factor_rays_comp.h"
#include "shaders/shared/factor_rays.h"

#define ROWS_MOST 4096u // of a batch
#define ROWS_FIRST 8u // of a batch when it is not known how long a row takes
#define TURNS_MOST 4u // of a lane, in each of which it traces a ray or a bundle

// Loop rounds of an invocation that it aims to stay below, where a driver ends loops after 65,535.
#define ROUNDS_SAFE 16000u

#define WEIGHT_MOST 65536u // of a ray: a float holds it exactly

#define ALPHA (1u << candil_Effect_EFFECT_ALPHA_MASK | 1u << candil_Effect_EFFECT_ALPHA_BLEND)
#define ALPHA_FROM (1u << candil_Effect_EFFECT_TEXTURES | 1u << candil_Effect_EFFECT_VERTEX_COLORS)

_Static_assert(BIND_FACTOR_COUNT <= BIND_MOST && BIND_FACTOR_TABLE >= BIND_RADIOSITY_OWN, "bindings are its own");
_Static_assert(PATCHES_MOST < 1u << FACTOR_WORD_SHIFT && RADIOSITY_FACE_SHIFT <= 32 - FACTOR_WORD_SHIFT,
	       "a word holds both");
_Static_assert(SPEC_FACTOR_MIRRORS >= SPEC_PASS && SPEC_FACTOR_END <= SPEC_SCENE, "constants are its own");

static const struct shader factor_rays_shader = {.name = "factor_rays",
						 .code = shader_factor_rays_comp,
						 .bytes = sizeof shader_factor_rays_comp,
						 .bindings = BIND_FACTOR_COUNT,
						 .texels = TRACE_TEXELS | 1u << BIND_FACTOR_TRIANGLES,
						 .push_bytes = sizeof(struct factor_push)};

struct rays {
	struct device *device;
	struct resident_scene *scene;
	const struct element_buffers *elements;
	struct rays_options options;
	uint32_t side; // elements
	uint32_t rows_most;
	uint32_t weight; // of a ray when it starts
	uint32_t turns;
	double row_us; // 0: not known
	struct factors_put *lost;
	struct trace trace;
	struct buffer job, counters, table, rows, dense, sums, seconds, triangles;
	struct pipeline *pipeline;
	struct binding_set bindings;
};

// ---- sizes ------------------------------------------------------------------------------------------------------------

static uint32_t rows_of(uint32_t side)
{
	const uint64_t fit = RAYS_DENSE_BYTES / ((uint64_t)side * sizeof(uint32_t) + 1);
	return fit < 1 ? 1 : fit > ROWS_MOST ? ROWS_MOST : (uint32_t)fit;
}

// Rows of a batch that leave others half of the memory that is left.
static uint32_t rows_within(const struct device *d, uint32_t side)
{
	const uint64_t left = d->budget > d->bytes ? d->budget - d->bytes : 0;
	const uint64_t fit = left / 2 / ((uint64_t)side * sizeof(uint32_t)), rows = rows_of(side);
	return fit < 1 ? 1 : fit < rows ? (uint32_t)fit : (uint32_t)rows;
}

// A row's sum is at most 1 for each element that a ray meets.
static uint32_t weight_of(const struct rays_options *o)
{
	if (!o->mirrors)
		return 1;
	const uint64_t fit = UINT32_MAX / ((uint64_t)o->rays * (o->bounces + 1));
	return fit > WEIGHT_MOST ? WEIGHT_MOST : (uint32_t)fit;
}

uint64_t rays_bytes(uint32_t patches, uint32_t triangles, const struct rays_options *o)
{
	const uint64_t rows = rows_of(2 * patches), row = 2 * (uint64_t)patches * sizeof(uint32_t);
	return rows * (row + sizeof(uint32_t) + sizeof(struct factor_sums)) + o->rays * sizeof(struct table_ray) +
	       triangles * (sizeof(struct factor_triangle) + sizeof(uint32_t)) + sizeof(struct scene_params) +
	       sizeof(struct pass_counters);
}

// ---- making it --------------------------------------------------------------------------------------------------------

// Of a plan's effects, those that change what a ray meets.
static uint32_t effects_of(const struct plan *plan)
{
	return plan->effects & ALPHA ? plan->effects & (ALPHA | ALPHA_FROM) : 0;
}

static enum status upload_table(struct rays *r, struct error *err)
{
	struct table_ray *rays;
	const uint32_t n = r->options.rays;
	enum status s = r->options.barycentre ? ray_table_cells(n, &rays, err) : ray_table_sobol(n, &rays, err);
	if (s == STATUS_OK)
		s = buffer_init_with(&r->table, r->device, rays, n * sizeof *rays, err);
	free(rays);
	return s;
}

static enum status upload_seconds(struct rays *r, const struct patch_faces *faces, struct error *err)
{
	uint32_t *of = malloc(faces->count * sizeof *of + 1);
	if (!of)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; i < faces->count; i++)
		of[i] = faces->list[i].triangle[1];
	enum status s = buffer_init_with(&r->seconds, r->device, of, faces->count * sizeof *of, err);
	free(of);
	return s;
}

static struct factor_triangle triangle_of(const struct elements *e, uint32_t i)
{
	const struct triangle *t = &e->patches.triangles[i];
	const uint32_t word = e->triangles[i];
	struct factor_triangle of = {.first = NONE};
	double normal[3];
	if (word == NONE)
		return of;
	const struct radiosity_face *f = &e->faces[word >> RADIOSITY_FACE_SHIFT];
	vec3_across(e->patches.vertices[t->vertex[0]].position, e->patches.vertices[t->vertex[1]].position,
		    e->patches.vertices[t->vertex[2]].position, normal);
	vec3_normalize(normal);
	for (int c = 0; c < 3; c++)
		of.normal[c] = (float)normal[c];
	of.first = f->first;
	of.u = f->u | (word & ((1u << RADIOSITY_FACE_SHIFT) - 1)) << FACTOR_WORD_SHIFT;
	of.v = f->v;
	of.x2 = f->x2;
	of.y2 = f->y2;
	return of;
}

static enum status upload_triangles(struct rays *r, const struct elements *e, struct error *err)
{
	const uint64_t texels = (uint64_t)e->triangle_count * sizeof(struct factor_triangle) / PIPELINE_TEXEL_BYTES;
	if (texels > r->device->limits.maxTexelBufferElements)
		return error_set(err, STATUS_MEMORY,
				 "%u triangles are more than this device can bind for form factors by rays (%u)",
				 e->triangle_count,
				 (uint32_t)(r->device->limits.maxTexelBufferElements * PIPELINE_TEXEL_BYTES /
					    sizeof(struct factor_triangle)));
	struct factor_triangle *of = malloc(e->triangle_count * sizeof *of + 1);
	if (!of)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; i < e->triangle_count; i++)
		of[i] = triangle_of(e, i);
	enum status s = buffer_init_with(&r->triangles, r->device, of, e->triangle_count * sizeof *of, err);
	free(of);
	return s;
}

static enum status make_buffers(struct rays *r, const struct plan *plan, const struct elements *e, struct error *err)
{
	struct plan own = *plan;
	struct scene_params params;
	own.effects = effects_of(plan);
	scene_params_fill(&own, &r->scene->view, false, &params);
	const uint32_t bindings = scene_bindings_shade(&own) | TRACE_BINDINGS;
	enum status s = resident_upload(r->scene, r->device, bindings, err);
	if (s == STATUS_OK)
		s = buffer_init_with(&r->job, r->device, &params, sizeof params, err);
	if (s == STATUS_OK)
		s = buffer_init(&r->counters, r->device, sizeof(struct pass_counters), BUFFER_DEVICE, err);
	if (s == STATUS_OK)
		s = buffer_init(&r->rows, r->device, r->rows_most * sizeof(uint32_t), BUFFER_STAGING, err);
	if (s == STATUS_OK)
		s = buffer_init(&r->sums, r->device, r->rows_most * sizeof(struct factor_sums), BUFFER_DEVICE, err);
	if (s == STATUS_OK)
		s = buffer_init(&r->dense, r->device, (uint64_t)r->rows_most * r->side * sizeof(uint32_t), BUFFER_DEVICE,
				err);
	if (s == STATUS_OK)
		s = buffer_clear(&r->dense, r->device, err);
	if (s == STATUS_OK)
		s = upload_seconds(r, &e->patches.faces, err);
	if (s == STATUS_OK)
		s = upload_triangles(r, e, err);
	return s == STATUS_OK ? upload_table(r, err) : s;
}

static enum status make_pass(struct rays *r, uint32_t effects, struct error *err)
{
	const struct buffer *buffers[BIND_MOST] = {NULL};
	struct constants c = {0};
	r->trace = trace_choose(r->device, r->scene, r->options.traversal);
	scene_set_constants(&c, r->scene, effects);
	trace_set_constants(&r->trace, &c);
	constants_set(&c, SPEC_FACTOR_MIRRORS, r->options.mirrors);
	constants_set(&c, SPEC_FACTOR_BARYCENTRE, r->options.barycentre);
	enum status s = pipeline_get(r->device, &factor_rays_shader, &c, &r->pipeline, err);
	if (s != STATUS_OK)
		return s;
	rays_fill(r, buffers);
	return binding_set_init(&r->bindings, r->device, r->pipeline, buffers, &r->counters, err);
}

static enum status check(const struct rays_options *o, const struct elements *e, struct error *err)
{
	if (o->rays < 1 || o->rays > RAY_TABLE_MOST)
		return error_set(err, STATUS_BAD_ARGUMENT, "%u rays are asked for: 1 to %u can be", o->rays, RAY_TABLE_MOST);
	if (o->mirrors && o->bounces > RAYS_BOUNCES_MOST)
		return error_set(err, STATUS_BAD_ARGUMENT, "%u bounces at mirrors are asked for: at most %u can be",
				 o->bounces, RAYS_BOUNCES_MOST);
	if (e->count == 0)
		return error_set(err, STATUS_BAD_ARGUMENT, "the scene has no patches");
	return STATUS_OK;
}

enum status rays_create(struct device *device, struct resident_scene *scene, const struct plan *plan,
			const struct elements *elements, const struct element_buffers *buffers,
			const struct rays_options *options, struct rays **rays, struct error *err)
{
	*rays = NULL;
	enum status s = check(options, elements, err);
	if (s != STATUS_OK)
		return s;
	struct rays *r = calloc(1, sizeof *r);
	if (!r)
		return error_set(err, STATUS_MEMORY, "out of memory");
	r->device = device;
	r->scene = scene;
	r->elements = buffers;
	r->options = *options;
	r->side = elements->count;
	r->rows_most = rows_within(device, r->side);
	r->weight = weight_of(options);
	r->turns = 1;
	r->lost = calloc(r->rows_most, sizeof *r->lost);
	s = r->lost ? make_buffers(r, plan, elements, err) : error_set(err, STATUS_MEMORY, "out of memory");
	if (s == STATUS_OK)
		s = make_pass(r, effects_of(plan), err);
	if (s != STATUS_OK) {
		rays_destroy(r);
		return s;
	}
	*rays = r;
	return STATUS_OK;
}

void rays_destroy(struct rays *r)
{
	if (!r)
		return;
	binding_set_finish(&r->bindings, r->device);
	struct buffer *all[] = {&r->job, &r->counters, &r->table, &r->rows, &r->dense, &r->sums, &r->seconds, &r->triangles};
	for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
		buffer_finish(all[i], r->device);
	free(r->lost);
	free(r);
}

void rays_fill(const struct rays *r, const struct buffer **of)
{
	trace_fill_buffers(r->scene, of);
	element_buffers_fill(r->elements, of);
	of[BIND_JOB] = &r->job;
	of[BIND_COUNTERS] = &r->counters;
	of[BIND_FACTOR_TABLE] = &r->table;
	of[BIND_FACTOR_ROWS] = &r->rows;
	of[BIND_FACTOR_DENSE] = &r->dense;
	of[BIND_FACTOR_SUMS] = &r->sums;
	of[BIND_FACTOR_SECONDS] = &r->seconds;
	of[BIND_FACTOR_TRIANGLES] = &r->triangles;
}

// ---- running it -------------------------------------------------------------------------------------------------------

static uint32_t groups_of(const struct rays *r)
{
	const uint32_t each = FACTOR_LANES * r->turns * (r->trace.packet ? BUNDLE_RAYS : 1);
	return (r->options.rays + each - 1) / each;
}

// `rays` 0: nothing is traced. Groups of a dispatch are at most what every device takes, 65,535 an axis.
static enum status run(struct rays *r, uint32_t count, uint32_t rays, struct error *err)
{
	VkCommandBuffer c = r->device->commands;
	const struct factor_push push = {
	    .patches = r->side / 2, .rays = rays, .turns = r->turns, .weight = r->weight, .bounces = r->options.bounces};
	enum status s = command_begin(r->device, err);
	if (s != STATUS_OK)
		return s;
	vkCmdFillBuffer(c, r->counters.handle, 0, VK_WHOLE_SIZE, 0);
	vkCmdFillBuffer(c, r->sums.handle, 0, VK_WHOLE_SIZE, 0);
	command_barrier(r->device);
	vkCmdBindPipeline(c, VK_PIPELINE_BIND_POINT_COMPUTE, r->pipeline->handle);
	vkCmdBindDescriptorSets(c, VK_PIPELINE_BIND_POINT_COMPUTE, r->pipeline->layout, 0, 1, &r->bindings.set, 0, NULL);
	vkCmdPushConstants(c, r->pipeline->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
	vkCmdDispatch(c, rays ? groups_of(r) : 1, count, 1);
	command_barrier(r->device);
	return command_finish(r->device, err);
}

enum status rays_compile(struct rays *r, struct error *err)
{
	if (r->pipeline->warm)
		return STATUS_OK;
	((uint32_t *)r->rows.map)[0] = 0;
	enum status s = run(r, 1, 0, err);
	if (s == STATUS_OK)
		pipeline_has_run(r->device, r->pipeline);
	return s;
}

uint32_t rays_batch(const struct rays *r, double budget_us)
{
	const double fit = r->row_us > 0 ? budget_us / r->row_us : ROWS_FIRST;
	return fit >= r->rows_most ? r->rows_most : fit > 1 ? (uint32_t)fit : 1;
}

enum status rays_clear(struct rays *r, struct error *err)
{
	return buffer_clear(&r->dense, r->device, err);
}

// How many turns a lane may do, by the rounds that those of this batch took.
static uint32_t next_turns(const struct rays *r, const struct pass_counters *counters)
{
	const uint64_t fit = counters->loop_rounds ? (uint64_t)ROUNDS_SAFE * r->turns / counters->loop_rounds : 1;
	return fit < 1 ? 1 : fit > TURNS_MOST ? TURNS_MOST : (uint32_t)fit;
}

// Trace, and with one turn a lane again where a driver ended the loops of several.
static enum status run_whole(struct rays *r, uint32_t count, struct error *err)
{
	struct pass_counters counters;
	for (;;) {
		enum status s = run(r, count, r->options.rays, err);
		if (s == STATUS_OK)
			s = buffer_read(&r->counters, r->device, 0, sizeof counters, &counters, err);
		if (s != STATUS_OK)
			return s;
		if (!counters.cut)
			break;
		if (r->turns == 1)
			return error_set(err, STATUS_TRAVERSAL_CUT,
					 "the driver ended a loop of the traversal: the form factors would be wrong");
		r->turns = 1;
		if ((s = rays_clear(r, err)) != STATUS_OK)
			return s;
	}
	r->turns = next_turns(r, &counters);
	return STATUS_OK;
}

enum status rays_trace(struct rays *r, const uint32_t *elements, uint32_t count, struct error *err)
{
	if (count > r->rows_most)
		return error_set(err, STATUS_INTERNAL, "%u rows are more than a batch has", count);
	if (count == 0)
		return STATUS_OK;
	enum status s = rays_compile(r, err);
	const uint64_t start = clock_us();
	memcpy(r->rows.map, elements, count * sizeof *elements);
	if (s == STATUS_OK)
		s = run_whole(r, count, err);
	struct factor_sums *sums = malloc(count * sizeof *sums);
	if (s == STATUS_OK && !sums)
		s = error_set(err, STATUS_MEMORY, "out of memory");
	if (s == STATUS_OK)
		s = buffer_read(&r->sums, r->device, 0, count * sizeof *sums, sums, err);
	for (uint32_t i = 0; s == STATUS_OK && i < count; i++)
		r->lost[i] = (struct factors_put){.element = elements[i],
						  .escaped = (float)(sums[i].escaped / rays_unit(r)),
						  .cut = (float)(sums[i].cut / rays_unit(r))};
	free(sums);
	if (s == STATUS_OK)
		r->row_us = (double)(clock_us() - start) / count;
	struct error other;
	if (s != STATUS_OK && !r->device->lost)
		rays_clear(r, &other);
	return s;
}

const struct buffer *rays_dense(const struct rays *r)
{
	return &r->dense;
}

double rays_unit(const struct rays *r)
{
	return (double)r->weight * r->options.rays;
}

const struct factors_put *rays_lost(const struct rays *r)
{
	return r->lost;
}
