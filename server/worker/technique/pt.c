// The path tracer's job on a device: buffers, pipelines, and a cursor over (sample, tile).
//
// A slice is one or more submissions, each as many tiles of one or more samples as should fit the rest of the budget by the
// speed measured so far. Where a slice ends changes no bit: a pixel's samples are added in the order of their index, and a
// tile's paths do not know about other tiles.
#include "server/worker/technique/pt.h"

#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/worker/image/frame.h"
#include "server/worker/plan.h"
#include "server/worker/resident.h"
#include "server/worker/technique/pt_resolve.h"
#include "server/worker/vk/command.h"
#include "server/worker/vk/pipeline.h"
#include "shaders/aov_comp.h"
#include "shaders/path_comp.h"

// Scattering events in one dispatch. Software drivers end an invocation's loops after some 65,000 rounds all told; sixteen
// events of two rays leave a ray 2,000 rounds.
#define SEGMENT_SOFTWARE 16u
#define TILES_PER_DISPATCH 4096u
#define DISPATCHES_PER_SUBMIT 256u
#define FIRST_TILES 16u

static const struct shader path_shader = {.name = "path",
					  .code = shader_path_comp,
					  .bytes = sizeof shader_path_comp,
					  .bindings = BIND_PATH_COUNT,
					  .push_bytes = sizeof(struct path_push)};
static const struct shader aov_shader = {.name = "aov",
					 .code = shader_aov_comp,
					 .bytes = sizeof shader_aov_comp,
					 .bindings = BIND_AOV_COUNT,
					 .push_bytes = sizeof(struct path_push)};

struct pass {
	struct pipeline *pipeline;
	struct binding_set bindings;
};

struct technique_job {
	struct device *device;
	struct resident_scene *scene;
	struct plan plan;
	uint32_t tiles;
	uint32_t segment;             // events in a dispatch
	uint32_t segments;            // dispatches a sample
	struct buffer job;            // struct pt_job
	struct buffer counters;       // struct pt_counters, growing
	struct buffer counters_host;  // what the last submission left in them
	struct buffer accumulator;
	struct buffer paths;          // only if segments > 1
	struct buffer aov;            // only if asked for
	struct pass path;
	struct pass aov_pass;
	// The cursor: next to do is tile `tile` of sample first_sample + `sample`.
	uint32_t sample, tile;
	uint32_t aov_tile;
	double tile_us;               // measured time of a tile of one sample; 0: not yet
	struct pt_counters seen;      // counters at the last look
	uint64_t rays, non_finite;
	uint64_t upload_us, compile_us, trace_us, aov_us;
};

static uint32_t tiles_of(const struct plan *plan)
{
	return (plan->width + TILE_SIDE - 1) / TILE_SIDE * ((plan->height + TILE_SIDE - 1) / TILE_SIDE);
}

static uint32_t segment_of(const struct device *device, const struct plan *plan)
{
	uint32_t whole = plan->depth + 1;
	uint32_t segment = plan->segment ? plan->segment : device->info.software ? SEGMENT_SOFTWARE : whole;
	return segment < whole ? segment : whole;
}

static uint32_t dispatch_tiles(const struct plan *plan)
{
	uint32_t tiles = tiles_of(plan);
	return tiles < TILES_PER_DISPATCH ? tiles : TILES_PER_DISPATCH;
}

static uint64_t paths_bytes(const struct device *device, const struct plan *plan)
{
	if (segment_of(device, plan) > plan->depth)
		return 0;
	return (uint64_t)dispatch_tiles(plan) * TILE_SIDE * TILE_SIDE * sizeof(struct path_state);
}

static uint64_t pixels_of(const struct plan *plan)
{
	return (uint64_t)plan->width * plan->height;
}

uint64_t pt_job_bytes(const struct device *device, const struct plan *plan)
{
	uint64_t bytes = sizeof(struct pt_job) + 2 * sizeof(struct pt_counters) + paths_bytes(device, plan);
	bytes += pixels_of(plan) * ACCUMULATOR_FLOATS * sizeof(float);
	if (plan->aovs)
		bytes += pixels_of(plan) * AOV_WORDS * sizeof(uint32_t);
	return bytes;
}

// ---- begin --------------------------------------------------------------------------------------------------------------

static uint32_t scene_bindings(const struct plan *plan)
{
	uint32_t bits = 1u << BIND_NODES | 1u << BIND_LEAF_TRIANGLES | 1u << BIND_TRIANGLES | 1u << BIND_VERTICES |
			1u << BIND_MATERIALS;
	if (plan_has(plan, candil_Effect_EFFECT_TEXTURES))
		bits |= 1u << BIND_TEXTURES | 1u << BIND_TEXELS | 1u << BIND_SRGB_TABLE;
	if (plan_has(plan, candil_Effect_EFFECT_EMITTERS))
		bits |= 1u << BIND_EMITTERS;
	if (plan_has(plan, candil_Effect_EFFECT_LIGHTS))
		bits |= 1u << BIND_LIGHTS;
	return bits;
}

// How next-event estimation divides its samples between the two kinds of light: by power, but never less than a tenth to
// either, for a sun's power says little about a room that it does not reach.
static float emitter_share(const struct plan *plan, const struct blob_header *blob)
{
	const double e = plan_has(plan, candil_Effect_EFFECT_EMITTERS) ? (double)blob->emitter_power : 0;
	const double l = plan_has(plan, candil_Effect_EFFECT_LIGHTS) ? (double)blob->light_power : 0;
	if (l <= 0)
		return e > 0 ? 1.0f : 0.0f;
	if (e <= 0)
		return 0.0f;
	double share = e / (e + l);
	return (float)(share < 0.1 ? 0.1 : share > 0.9 ? 0.9 : share);
}

static void fill_job(const struct technique_job *j, struct pt_job *out)
{
	const struct plan *p = &j->plan;
	const struct blob_header *blob = j->scene->blob;
	memset(out, 0, sizeof *out);
	out->width = p->width;
	out->height = p->height;
	out->tiles_x = (p->width + TILE_SIDE - 1) / TILE_SIDE;
	out->depth = p->depth;
	out->seed[0] = (uint32_t)p->seed;
	out->seed[1] = (uint32_t)(p->seed >> 32);
	out->emitter_count = blob_count(blob, BLOB_EMITTERS);
	out->light_count = blob_count(blob, BLOB_LIGHTS);
	out->emitter_share = emitter_share(p, blob);
	out->emitter_power_inv = blob->emitter_power > 0 ? 1.0f / blob->emitter_power : 0.0f;
	out->orthographic = p->camera.orthographic ? 1.0f : 0.0f;
	for (int i = 0; i < 3; i++) {
		out->eye[i] = (float)(p->camera.eye[i] - blob->origin[i]);
		out->forward[i] = (float)p->camera.forward[i];
		out->right[i] = (float)p->camera.right[i];
		out->up[i] = (float)p->camera.up[i];
		out->background[i] = p->background[i];
	}
}

static enum status make_buffers(struct technique_job *j, struct error *err)
{
	struct device *d = j->device;
	struct pt_job params;
	fill_job(j, &params);
	enum status s = buffer_init_with(&j->job, d, &params, sizeof params, err);
	if (s == STATUS_OK)
		s = buffer_init(&j->counters, d, sizeof(struct pt_counters), BUFFER_DEVICE, err);
	if (s == STATUS_OK)
		s = buffer_clear(&j->counters, d, err);
	if (s == STATUS_OK)
		s = buffer_init(&j->counters_host, d, sizeof(struct pt_counters), BUFFER_READBACK, err);
	if (s == STATUS_OK)
		s = buffer_init(&j->accumulator, d, pixels_of(&j->plan) * ACCUMULATOR_FLOATS * sizeof(float), BUFFER_DEVICE, err);
	if (s == STATUS_OK)
		s = buffer_clear(&j->accumulator, d, err);
	if (s == STATUS_OK && j->segments > 1)
		s = buffer_init(&j->paths, d, paths_bytes(d, &j->plan), BUFFER_DEVICE, err);
	if (s == STATUS_OK && j->plan.aovs)
		s = buffer_init(&j->aov, d, pixels_of(&j->plan) * AOV_WORDS * sizeof(uint32_t), BUFFER_DEVICE, err);
	if (s == STATUS_OK && j->plan.aovs)
		s = buffer_clear(&j->aov, d, err);
	return s;
}

// Packets pay where a lane is a part of a CPU's vector; a GPU's lanes each fetch for themselves as quickly.
static bool walks_in_packets(const struct device *device, const struct plan *plan)
{
	const bool wanted = plan->traversal == TRAVERSAL_PACKET || (plan->traversal == TRAVERSAL_AUTO && device->info.software);
	return wanted && device->info.packets;
}

// Pipeline and bindings of one shader. A new pipeline runs once over nothing, so that the driver's compiler works now, under
// its own name in the account, and not in some slice.
static enum status make_pass(struct technique_job *j, const struct shader *shader, struct pass *pass, struct error *err)
{
	struct device *d = j->device;
	uint32_t constants[SPEC_COUNT];
	for (uint32_t i = 0; i < SPEC_EFFECTS; i++)
		constants[i] = plan_has(&j->plan, (candil_Effect)i);
	constants[SPEC_RESUMED] = j->segments > 1;
	constants[SPEC_PACKET] = walks_in_packets(d, &j->plan);
	constants[SPEC_WIDTH] = d->info.subgroup;
	const uint64_t start = clock_us();
	enum status s = pipeline_get(d, shader, constants, SPEC_COUNT, &pass->pipeline, err);
	if (s != STATUS_OK)
		return s;
	const struct buffer *buffers[PIPELINE_BINDINGS_MAX] = {NULL};
	for (uint32_t i = 0; i < BIND_SCENE_COUNT; i++)
		buffers[i] = &j->scene->buffers[i];
	buffers[BIND_JOB] = &j->job;
	buffers[BIND_COUNTERS] = &j->counters;
	buffers[BIND_ACCUMULATOR] = shader == &aov_shader ? &j->aov : &j->accumulator;
	if (shader == &path_shader)
		buffers[BIND_PATHS] = &j->paths;
	s = binding_set_init(&pass->bindings, d, pass->pipeline, buffers, &j->counters_host, err);
	if (s != STATUS_OK || pass->pipeline->warm)
		return s;
	s = command_begin(d, err);
	if (s != STATUS_OK)
		return s;
	const struct path_push nothing = {.first_tile = j->tiles};
	vkCmdBindPipeline(d->commands, VK_PIPELINE_BIND_POINT_COMPUTE, pass->pipeline->handle);
	vkCmdBindDescriptorSets(d->commands, VK_PIPELINE_BIND_POINT_COMPUTE, pass->pipeline->layout, 0, 1, &pass->bindings.set, 0,
				NULL);
	vkCmdPushConstants(d->commands, pass->pipeline->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof nothing, &nothing);
	vkCmdDispatch(d->commands, 1, 1, 1);
	s = command_finish(d, err);
	pass->pipeline->warm = s == STATUS_OK;
	j->compile_us += clock_us() - start;
	return s;
}

static void pt_end(struct technique_job *j)
{
	if (!j)
		return;
	binding_set_finish(&j->path.bindings, j->device);
	binding_set_finish(&j->aov_pass.bindings, j->device);
	struct buffer *buffers[] = {&j->job, &j->counters, &j->counters_host, &j->accumulator, &j->paths, &j->aov};
	for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++)
		buffer_finish(buffers[i], j->device);
	free(j);
}

static enum status pt_begin(struct device *device, struct resident_scene *scene, const struct plan *plan,
			    struct technique_job **job, struct error *err)
{
	struct technique_job *j = calloc(1, sizeof *j);
	if (!j)
		return error_set(err, STATUS_MEMORY, "out of memory");
	j->device = device;
	j->scene = scene;
	j->plan = *plan;
	j->tiles = tiles_of(plan);
	j->segment = segment_of(device, plan);
	j->segments = (plan->depth + 1 + j->segment - 1) / j->segment;
	const uint64_t start = clock_us();
	enum status s = resident_upload(scene, device, scene_bindings(plan), err);
	if (s == STATUS_OK)
		s = make_buffers(j, err);
	j->upload_us = clock_us() - start;
	if (s == STATUS_OK)
		s = make_pass(j, &path_shader, &j->path, err);
	if (s == STATUS_OK && plan->aovs)
		s = make_pass(j, &aov_shader, &j->aov_pass, err);
	if (s != STATUS_OK) {
		pt_end(j);
		return s;
	}
	*job = j;
	return STATUS_OK;
}

// ---- step ---------------------------------------------------------------------------------------------------------------

static void bind(const struct technique_job *j, const struct pass *pass)
{
	VkCommandBuffer c = j->device->commands;
	vkCmdBindPipeline(c, VK_PIPELINE_BIND_POINT_COMPUTE, pass->pipeline->handle);
	vkCmdBindDescriptorSets(c, VK_PIPELINE_BIND_POINT_COMPUTE, pass->pipeline->layout, 0, 1, &pass->bindings.set, 0, NULL);
}

static void dispatch(const struct technique_job *j, const struct pass *pass, const struct path_push *push)
{
	VkCommandBuffer c = j->device->commands;
	vkCmdPushConstants(c, pass->pipeline->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof *push, push);
	vkCmdDispatch(c, push->tile_count, 1, 1);
	// The next dispatch may add to the same pixels, or go on with the same paths.
	command_barrier(j->device);
}

static uint32_t at_most(uint64_t a, uint32_t b)
{
	return a < b ? (uint32_t)a : b;
}

// Record `count` tiles of work from the cursor on, and move it. Returns how many were recorded.
static uint64_t record_paths(struct technique_job *j, uint64_t count)
{
	const struct plan *p = &j->plan;
	uint64_t recorded = 0;
	bind(j, &j->path);
	for (uint32_t n = 0; n < DISPATCHES_PER_SUBMIT && recorded < count && j->sample < p->samples; n += j->segments) {
		const uint32_t global = p->first_sample + j->sample;
		uint32_t tiles = at_most(count - recorded, j->tiles - j->tile);
		tiles = at_most(tiles, TILES_PER_DISPATCH);
		struct path_push push = {.first_tile = j->tile,
					 .tile_count = tiles,
					 .sample_half = global & 1u,
					 .sample_index = global >> 1,
					 .event_count = j->segment};
		for (uint32_t s = 0; s < j->segments; s++) {
			push.first_event = s * j->segment;
			dispatch(j, &j->path, &push);
		}
		recorded += tiles;
		j->tile += tiles;
		if (j->tile == j->tiles) {
			j->tile = 0;
			j->sample++;
		}
	}
	return recorded;
}

static uint64_t record_aov(struct technique_job *j, uint64_t count)
{
	bind(j, &j->aov_pass);
	uint32_t tiles = at_most(at_most(count, j->tiles - j->aov_tile), TILES_PER_DISPATCH);
	const struct path_push push = {.first_tile = j->aov_tile, .tile_count = tiles};
	dispatch(j, &j->aov_pass, &push);
	j->aov_tile += tiles;
	return tiles;
}

static enum status take_counters(struct technique_job *j, struct error *err)
{
	struct pt_counters now;
	memcpy(&now, j->counters_host.map, sizeof now);
	j->rays += now.rays - j->seen.rays;   // modulo 2^32, which no submission reaches
	j->non_finite += now.non_finite - j->seen.non_finite;
	j->seen = now;
	if (now.cut)
		return error_set(err, STATUS_TRAVERSAL_CUT,
				 "the driver ended a loop of the path tracer early: set pt.segment lower (it is %u)", j->segment);
	return STATUS_OK;
}

static enum status submit(struct technique_job *j, uint64_t count, struct error *err)
{
	struct device *d = j->device;
	const bool aov = j->plan.aovs && j->aov_tile < j->tiles;
	enum status s = command_begin(d, err);
	if (s != STATUS_OK)
		return s;
	// One ray a pixel where a path has many: the same time does more tiles.
	uint64_t recorded = aov ? record_aov(j, 16 * count) : record_paths(j, count);
	const VkBufferCopy all = {.size = sizeof(struct pt_counters)};
	vkCmdCopyBuffer(d->commands, j->counters.handle, j->counters_host.handle, 1, &all);
	command_barrier(d);
	const uint64_t start = clock_us();
	s = command_finish(d, err);
	const uint64_t us = clock_us() - start;
	if (s != STATUS_OK)
		return s;
	if (aov) {
		j->aov_us += us;
		return STATUS_OK;
	}
	j->trace_us += us;
	double measured = (double)us / (double)recorded;
	j->tile_us = j->tile_us > 0 ? 0.5 * (j->tile_us + measured) : measured;
	return take_counters(j, err);
}

static enum status pt_step(struct technique_job *j, uint32_t budget_us, struct step_result *result, struct error *err)
{
	const uint64_t start = clock_us();
	uint64_t spent = 0;
	do {
		// Half a tile's worth of rounding aside, the last submission ends with the budget.
		uint64_t tiles = j->tile_us > 0 ? (uint64_t)((double)(budget_us - spent) / j->tile_us) : FIRST_TILES;
		enum status s = submit(j, tiles > 0 ? tiles : 1, err);
		if (s != STATUS_OK)
			return s;
		spent = clock_us() - start;
	} while (j->sample < j->plan.samples && spent < budget_us && (double)(budget_us - spent) > j->tile_us);
	result->samples_done = j->sample;
	result->finished = j->sample == j->plan.samples;
	result->fraction = ((double)j->sample + (double)j->tile / j->tiles) / j->plan.samples;
	return STATUS_OK;
}

// ---- read ---------------------------------------------------------------------------------------------------------------

static void read_aov(const struct technique_job *j, const uint32_t *words, struct frame *f)
{
	for (uint64_t i = 0; i < pixels_of(&j->plan); i++, words += AOV_WORDS) {
		if (f->depth)
			memcpy(&f->depth[i], words, sizeof(float));
		if (f->normal)
			memcpy(&f->normal[3 * i], words + 1, 3 * sizeof(float));
		if (f->albedo)
			memcpy(&f->albedo[3 * i], words + 4, 3 * sizeof(float));
		if (f->id)
			f->id[i] = words[7];
	}
}

static void account(const struct technique_job *j, struct frame *f)
{
	f->samples = j->sample;
	f->non_finite_samples = j->non_finite;
	f->rays = j->rays;
	if (j->upload_us)
		frame_add_stage(f, "upload", j->upload_us);
	if (j->compile_us)
		frame_add_stage(f, "compile", j->compile_us);
	if (j->plan.aovs)
		frame_add_stage(f, "aov", j->aov_us);
	frame_add_stage(f, "trace", j->trace_us);
}

static enum status pt_read(struct technique_job *j, struct frame **frame, struct error *err)
{
	struct frame *f = NULL;
	const uint64_t start = clock_us();
	const size_t sums_bytes = (size_t)pixels_of(&j->plan) * ACCUMULATOR_FLOATS * sizeof(float);
	const size_t aov_bytes = (size_t)j->aov.bytes;
	float *sums = malloc(sums_bytes);
	uint32_t *words = aov_bytes ? malloc(aov_bytes) : NULL;
	enum status s = sums && (words || !aov_bytes) ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	if (s == STATUS_OK)
		s = frame_create(j->plan.width, j->plan.height, j->plan.aovs, &f, err);
	if (s == STATUS_OK)
		s = buffer_read(&j->accumulator, j->device, 0, sums_bytes, sums, err);
	if (s == STATUS_OK && words)
		s = buffer_read(&j->aov, j->device, 0, aov_bytes, words, err);
	if (s == STATUS_OK) {
		const struct pt_progress at = {.first_sample = j->plan.first_sample, .samples = j->sample, .tiles = j->tile};
		pt_resolve(sums, &at, f);
		if (words)
			read_aov(j, words, f);
		account(j, f);
		frame_add_stage(f, "resolve", clock_us() - start);
		*frame = f;
		f = NULL;
	}
	frame_destroy(f);
	free(words);
	free(sums);
	return s;
}

const struct technique technique_pt = {.name = "pt", .begin = pt_begin, .step = pt_step, .read = pt_read, .end = pt_end};
