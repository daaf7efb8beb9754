#include "server/worker/technique/radiosity/sight.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/worker/technique/common/scene_traits.h"
#include "server/worker/technique/radiosity/ray_table.h"
#include "server/worker/trace/trace.h"
#include "shaders/shared/sight.h"
#include "shaders/sight_comp.h"

#define FIRST_PAIRS 256u // when it is not known how long a pair takes

_Static_assert(SIGHT_PROBE % SIGHT_AT_ONCE == 0, "a probe is whole dispatches");

static const struct shader sight_shader = {.name = "sight",
					   .code = shader_sight_comp,
					   .bytes = sizeof shader_sight_comp,
					   .bindings = BIND_RADIOSITY_COUNT,
					   .texels = TRACE_TEXELS,
					   .push_bytes = sizeof(struct patch_push)};

_Static_assert(SIGHT_RAYS_MOST / SIGHT_AT_ONCE <= SIGHT_PAIRS_MOST, "results of a pair have room");

// What the rays of a pair met, as in struct sight_result.
struct found {
	double seen, all;
	uint32_t free, rays;
};

struct sight {
	struct patch_pass pass;
	uint32_t rays;
	struct buffer pairs; // two uint each, in the host's memory
	struct buffer results; // struct sight_result, SIGHT_PAIRS_MOST of them
	struct buffer table; // struct table_ray: SIGHT_PROBE of them, then `rays`
	struct sight_result *read; // a copy of them
	struct found *found; // of SIGHT_PAIRS_MOST pairs
	uint32_t *partly; // pairs of those that are partly hidden
	double pair_us; // 0: not known
};

// Those of the plan's effects that change what a ray meets.
static uint32_t effects_of(const struct plan *plan)
{
	const uint32_t alpha = 1u << candil_Effect_EFFECT_ALPHA_MASK | 1u << candil_Effect_EFFECT_ALPHA_BLEND;
	const uint32_t from = 1u << candil_Effect_EFFECT_TEXTURES | 1u << candil_Effect_EFFECT_VERTEX_COLORS;
	return plan->effects & alpha ? plan->effects & (alpha | from) : 0;
}

static enum status upload_table(struct sight *s, struct error *err)
{
	struct table_ray *probe = NULL, *rest = NULL;
	struct table_ray *all = malloc((SIGHT_PROBE + s->rays) * sizeof *all);
	enum status status =
	    all ? ray_table_sobol(SIGHT_PROBE, &probe, err) : error_set(err, STATUS_MEMORY, "out of memory");
	if (status == STATUS_OK)
		status = ray_table_sobol(s->rays, &rest, err);
	if (status == STATUS_OK) {
		memcpy(all, probe, SIGHT_PROBE * sizeof *all);
		memcpy(all + SIGHT_PROBE, rest, s->rays * sizeof *all);
		status = buffer_init_with(&s->table, s->pass.device, all, (SIGHT_PROBE + s->rays) * sizeof *all, err);
	}
	free(probe);
	free(rest);
	free(all);
	return status;
}

static enum status sight_init(struct sight *s, const struct patch_scene *of, struct error *err)
{
	const uint32_t effects = effects_of(of->plan);
	struct device *d = s->pass.device;
	struct constants c = {0};
	s->read = malloc(SIGHT_PAIRS_MOST * sizeof *s->read);
	s->found = malloc(SIGHT_PAIRS_MOST * sizeof *s->found);
	s->partly = malloc(SIGHT_PAIRS_MOST * sizeof *s->partly);
	if (!s->read || !s->found || !s->partly)
		return error_set(err, STATUS_MEMORY, "out of memory");
	enum status status = resident_upload(of->scene, d, TRACE_BINDINGS, err);
	if (status == STATUS_OK)
		status = patch_pass_init(&s->pass, of, effects, false, err);
	if (status == STATUS_OK)
		status = buffer_init(&s->pairs, d, SIGHT_PAIRS_MOST * 2 * sizeof(uint32_t), BUFFER_STAGING, err);
	if (status == STATUS_OK)
		status = buffer_init(&s->results, d, SIGHT_PAIRS_MOST * sizeof(struct sight_result), BUFFER_DEVICE, err);
	if (status == STATUS_OK)
		status = upload_table(s, err);
	if (status != STATUS_OK)
		return status;
	memset(s->pairs.map, 0, s->pairs.bytes);
	const struct trace trace = trace_choose(d, of->scene, TRACE_AUTO);
	scene_set_constants(&c, of->scene, effects);
	trace_set_constants(&trace, &c);
	constants_set(&c, SPEC_PATCH_COUNT, of->elements->patches.count);
	const struct buffer *const own[3] = {&s->pairs, &s->results, &s->table};
	return patch_pass_bind(&s->pass, of, &sight_shader, &c, own, err);
}

enum status sight_create(const struct patch_scene *of, uint32_t rays, struct device *device, struct sight **out,
			 struct error *err)
{
	*out = NULL;
	if (rays < SIGHT_PROBE || rays > SIGHT_RAYS_MOST || rays % SIGHT_AT_ONCE)
		return error_set(err, STATUS_BAD_ARGUMENT, "%u rays between a pair: multiples of %u from %u to %u can be",
				 rays, SIGHT_AT_ONCE, SIGHT_PROBE, SIGHT_RAYS_MOST);
	struct sight *s = calloc(1, sizeof *s);
	if (!s)
		return error_set(err, STATUS_MEMORY, "out of memory");
	s->pass.device = device;
	s->rays = rays;
	const enum status status = sight_init(s, of, err);
	if (status != STATUS_OK) {
		sight_destroy(s);
		return status;
	}
	*out = s;
	return STATUS_OK;
}

void sight_destroy(struct sight *s)
{
	if (!s)
		return;
	patch_pass_finish(&s->pass);
	buffer_finish(&s->pairs, s->pass.device);
	buffer_finish(&s->results, s->pass.device);
	buffer_finish(&s->table, s->pass.device);
	free(s->read);
	free(s->found);
	free(s->partly);
	free(s);
}

bool sight_compiled(const struct sight *s)
{
	return patch_pass_compiled(&s->pass);
}

enum status sight_compile(struct sight *s, struct error *err)
{
	return patch_pass_compile(&s->pass, err);
}

uint32_t (*sight_pairs(struct sight *s))[2]
{
	return s->pairs.map;
}

// Add up what the invocations of each pair found, in their order.
static void add_up(const struct sight_result *of, uint32_t pairs, uint32_t each, struct found *out)
{
	for (uint32_t k = 0; k < pairs; k++) {
		out[k] = (struct found){0};
		for (uint32_t i = 0; i < each; i++, of++) {
			out[k].seen += (double)of->seen;
			out[k].all += (double)of->all;
			out[k].free += of->free;
			out[k].rays += of->rays;
		}
	}
}

// Trace the rays of so many points of the table, from `first` on, between each of the first `count` pairs of the buffer.
static enum status look(struct sight *s, uint32_t count, uint32_t first, uint32_t rays, struct error *err)
{
	const uint32_t each = rays / SIGHT_AT_ONCE, fit = SIGHT_PAIRS_MOST / each;
	enum status status = STATUS_OK;
	for (uint32_t at = 0, n; status == STATUS_OK && at < count; at += n) {
		n = count - at < fit ? count - at : fit;
		const struct patch_push push = {.first = at, .count = n * each, .all = each, .point = first};
		status = patch_pass_run(&s->pass, &push, err);
		if (status == STATUS_OK)
			status =
			    buffer_read(&s->results, s->pass.device, 0, (uint64_t)n * each * sizeof *s->read, s->read, err);
		if (status == STATUS_OK)
			add_up(s->read, n, each, s->found + at);
	}
	struct pass_counters counters = {0};
	if (status == STATUS_OK)
		status = buffer_read(&s->pass.counters, s->pass.device, 0, sizeof counters, &counters, err);
	if (status == STATUS_OK && counters.cut > 0)
		return error_set(err, STATUS_TRAVERSAL_CUT,
				 "the driver ended a loop of the traversal: the form factors would be wrong");
	return status;
}

// Turned so that the lower element comes first: both ways round, a pair is the same rays.
static void order(uint32_t (*pairs)[2], uint32_t count)
{
	for (uint32_t k = 0; k < count; k++) {
		const uint32_t a = pairs[k][0], b = pairs[k][1];
		pairs[k][0] = a < b ? a : b;
		pairs[k][1] = a < b ? b : a;
	}
}

enum status sight_find(struct sight *s, uint32_t count, float *share, struct error *err)
{
	uint32_t(*pairs)[2] = sight_pairs(s), partly = 0;
	const uint64_t start = clock_us();
	if (count == 0)
		return STATUS_OK;
	order(pairs, count);
	enum status status = sight_compile(s, err);
	if (status == STATUS_OK)
		status = look(s, count, 0, SIGHT_PROBE, err);
	for (uint32_t k = 0; status == STATUS_OK && k < count; k++) {
		const struct found *r = &s->found[k];
		// Of a pair so much on edge that no points face each other nothing is known to be hidden.
		share[k] = r->free == r->rays ? 1 : 0;
		if (r->free == 0 || r->free == r->rays)
			continue;
		memcpy(pairs[partly], pairs[k], sizeof pairs[k]);
		s->partly[partly++] = k;
	}
	if (status == STATUS_OK && partly > 0)
		status = look(s, partly, SIGHT_PROBE, s->rays, err);
	for (uint32_t k = 0; status == STATUS_OK && k < partly; k++)
		share[s->partly[k]] = (float)fmin(s->found[k].seen / s->found[k].all, 1);
	if (status == STATUS_OK)
		s->pair_us = (double)(clock_us() - start) / count;
	return status;
}

uint32_t sight_batch(const struct sight *s, double budget_us)
{
	const double fit = s->pair_us > 0 ? budget_us / s->pair_us : FIRST_PAIRS;
	return fit >= SIGHT_PAIRS_MOST ? SIGHT_PAIRS_MOST : fit > PATCH_GROUP ? (uint32_t)fit : PATCH_GROUP;
}

uint64_t sight_bytes(uint32_t faces, uint32_t rays)
{
	return (uint64_t)(SIGHT_PROBE + rays) * sizeof(struct table_ray) +
	       SIGHT_PAIRS_MOST * (2ull * sizeof(uint32_t) + sizeof(struct sight_result)) + sizeof(struct scene_params) +
	       sizeof(struct pass_counters) + faces * 2ull * sizeof(uint32_t);
}
