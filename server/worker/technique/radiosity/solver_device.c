// What a solver has on the device, and the recording of its passes.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/worker/technique/radiosity/solver_parts.h"
#include "server/worker/vk/command.h"
#include "shaders/solve_gather_comp.h"
#include "shaders/solve_step_comp.h"

#define SUBGROUP_LEAST 4u // lanes
#define GROUPS_MOST 32768u // of a dispatch: every device takes so many

_Static_assert(BIND_STEP_COUNT <= BIND_MOST && BIND_GATHER_COUNT <= BIND_MOST, "a binding set has room for every pass");

static const struct shader gather_shader = {.name = "solve_gather",
					    .code = shader_solve_gather_comp,
					    .bytes = sizeof shader_solve_gather_comp,
					    .bindings = BIND_GATHER_COUNT,
					    .texels = 1u << BIND_GATHER_COLUMNS | 1u << BIND_GATHER_VALUES |
						      1u << BIND_GATHER_SOURCE,
					    .push_bytes = sizeof(struct gather_push)};
static const struct shader step_shader = {.name = "solve_step",
					  .code = shader_solve_step_comp,
					  .bytes = sizeof shader_solve_step_comp,
					  .bindings = BIND_STEP_COUNT,
					  .push_bytes = sizeof(struct step_push)};

static enum status get_gather(struct device *device, bool pairs, struct pipeline **pipeline, struct error *err)
{
	struct constants c = {0};
	constants_set(&c, SPEC_GATHER_PAIRS, pairs);
	return pipeline_get(device, &gather_shader, &c, pipeline, err);
}

static enum status get_step(struct device *device, uint32_t step, struct pipeline **pipeline, struct error *err)
{
	struct constants c = {0};
	constants_set(&c, SPEC_STEP, step);
	return pipeline_get(device, &step_shader, &c, pipeline, err);
}

// Whether a way has such a pass. Where gradients are stuck they go on by relaxation, so they have both.
static bool has_step(enum solver_way way, uint32_t step)
{
	return way == SOLVER_GRADIENT || (step != STEP_AIM && step != STEP_MOVE && step != STEP_TURN);
}

// ---- the first run
// --------------------------------------------------------------------------------------------------------

// Run a pipeline over nothing, which is when some drivers compile.
static enum status warm_up(struct device *device, struct pipeline *pipeline, const struct buffer *filler, struct error *err)
{
	static const uint32_t nothing[sizeof(struct step_push) / 4] = {0};
	const struct buffer *buffers[BIND_MOST] = {NULL};
	struct binding_set set;
	if (pipeline->warm)
		return STATUS_OK;
	enum status s = binding_set_init(&set, device, pipeline, buffers, filler, err);
	if (s != STATUS_OK)
		return s;
	s = command_begin(device, err);
	if (s == STATUS_OK) {
		VkCommandBuffer c = device->commands;
		vkCmdBindPipeline(c, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline->handle);
		vkCmdBindDescriptorSets(c, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline->layout, 0, 1, &set.set, 0, NULL);
		vkCmdPushConstants(c, pipeline->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, pipeline->shader->push_bytes,
				   nothing);
		vkCmdDispatch(c, 1, 1, 1);
		s = command_finish(device, err);
	}
	if (s == STATUS_OK)
		pipeline_has_run(device, pipeline);
	binding_set_finish(&set, device);
	return s;
}

enum status solver_compile(struct device *device, enum solver_way way, struct error *err)
{
	struct buffer filler;
	struct pipeline *pipeline;
	enum status s = buffer_init(&filler, device, 1024, BUFFER_DEVICE, err);
	if (s == STATUS_OK)
		s = buffer_clear(&filler, device, err);
	for (uint32_t i = 0; s == STATUS_OK && i < 2; i++) {
		s = get_gather(device, i == 1, &pipeline, err);
		if (s == STATUS_OK)
			s = warm_up(device, pipeline, &filler, err);
	}
	for (uint32_t i = 0; s == STATUS_OK && i < STEP_COUNT; i++)
		if (has_step(way, i)) {
			s = get_step(device, i, &pipeline, err);
			if (s == STATUS_OK)
				s = warm_up(device, pipeline, &filler, err);
		}
	buffer_finish(&filler, device);
	return s;
}

// ---- rows
// -----------------------------------------------------------------------------------------------------------------

static uint32_t part_of(const struct solver *s, uint32_t element)
{
	return (uint32_t)((uint64_t)element * s->parts / s->count);
}

// Append the rows of elements [first, end) that are in a block.
static void list_run(struct solver *s, const uint8_t *which, uint32_t part, uint32_t block, uint32_t first, uint32_t end)
{
	struct solver_run run = {.part = part, .block = block, .first = s->listed};
	for (uint32_t i = first; i < end; i++) {
		const struct factors_row *r = &s->factors->rows[i];
		if (r->block == block && r->count > 0 && (!which || which[i]))
			s->list[s->listed++] = (struct solve_row){.element = i, .first = r->first, .count = r->count};
	}
	run.end = s->listed;
	if (run.end > run.first)
		s->runs[s->run_count++] = run;
}

static enum status list_rows(struct solver *s, const uint8_t *which, struct error *err)
{
	const uint64_t runs = (uint64_t)s->parts * s->factors->block_count;
	s->list = malloc((s->count ? s->count : 1) * sizeof *s->list);
	s->runs = malloc((runs ? runs : 1) * sizeof *s->runs);
	if (!s->list || !s->runs)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t part = 0, first = 0, end; part < s->parts; part++, first = end) {
		end = first;
		while (end < s->count && part_of(s, end) == part)
			end++;
		for (uint32_t block = 0; block < s->factors->block_count; block++)
			list_run(s, which, part, block, first, end);
	}
	return buffer_init_with(&s->rows, s->device, s->list, s->listed * sizeof *s->list, err);
}

// ---- buffers
// --------------------------------------------------------------------------------------------------------------

// Upload three floats for each element as four; `fourth` (NULL: 0) is multiplied by `factor`.
static enum status upload(struct solver *s, struct buffer *to, const float *from, const float *fourth, double factor,
			  struct error *err)
{
	float *packed = calloc(s->count, 4 * sizeof *packed);
	if (!packed)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; i < s->count; i++) {
		memcpy(packed + 4ull * i, from + 3ull * i, 3 * sizeof *packed);
		packed[4ull * i + 3] = fourth ? (float)((double)fourth[i] * factor) : 0;
	}
	const enum status status = buffer_init_with(to, s->device, packed, s->count * 4ull * sizeof *packed, err);
	free(packed);
	return status;
}

static enum status cleared(struct solver *s, struct buffer *b, uint32_t vectors, struct error *err)
{
	enum status status = buffer_init(b, s->device, (uint64_t)s->count * vectors * 4 * sizeof(float), BUFFER_DEVICE, err);
	return status == STATUS_OK ? buffer_clear(b, s->device, err) : status;
}

// H as pairs, of which the second are 0.
static enum status upload_field(struct solver *s, const float *start, struct error *err)
{
	const uint64_t bytes = s->count * 8ull * sizeof(float);
	float *pairs = calloc(1, bytes);
	if (!pairs)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; i < s->count; i++)
		memcpy(pairs + 8ull * i, start + 3ull * i, 3 * sizeof *pairs);
	const enum status status = buffer_init_with(&s->field, s->device, pairs, bytes, err);
	free(pairs);
	return status;
}

static enum status make_buffers(struct solver *s, const struct solver_problem *p, struct error *err)
{
	const uint64_t maxima = SOLVE_MAXIMA * 3 * sizeof(uint32_t);
	float area = 0;
	for (uint32_t i = 0; i < s->count; i++)
		area = fmaxf(area, p->area[i]);
	s->partial_count = (s->count + SOLVE_LANES - 1) / SOLVE_LANES * (SOLVE_LANES / SUBGROUP_LEAST);
	enum status status = upload(s, &s->albedo, p->albedo, p->area, area > 0 ? 1.0 / (double)area : 0, err);
	if (status == STATUS_OK)
		status = upload(s, &s->exitance, p->exitance, NULL, 0, err);
	if (status == STATUS_OK)
		status = upload(s, &s->irradiance, p->irradiance, NULL, 0, err);
	struct buffer *const ones[] = {&s->residual, &s->change, &s->direction, &s->image};
	for (size_t i = 0; status == STATUS_OK && i < sizeof ones / sizeof *ones; i++)
		status = cleared(s, ones[i], 1, err);
	if (status == STATUS_OK)
		status = p->start ? upload_field(s, p->start, err) : cleared(s, &s->field, 2, err);
	struct buffer *const twos[] = {&s->source, &s->sums};
	for (size_t i = 0; status == STATUS_OK && i < sizeof twos / sizeof *twos; i++)
		status = cleared(s, twos[i], 2, err);
	if (status == STATUS_OK)
		status = buffer_init(&s->maxima, s->device, maxima, BUFFER_DEVICE, err);
	if (status == STATUS_OK)
		status = buffer_init(&s->maxima_host, s->device, maxima, BUFFER_READBACK, err);
	if (status == STATUS_OK)
		status = buffer_init(&s->partials, s->device, s->partial_count * 8ull * sizeof(float), BUFFER_READBACK, err);
	if (status == STATUS_OK)
		memset(s->partials.map, 0, s->partials.bytes);
	return status;
}

uint64_t solver_bytes(uint32_t elements)
{
	const uint64_t vectors = (7 + 3 * 2) * 4 * sizeof(float), partials = 8 * sizeof(float) / SUBGROUP_LEAST;
	return (elements + (uint64_t)SOLVE_LANES) * (vectors + partials + sizeof(struct solve_row));
}

static enum status bind_gathers(struct solver *s, struct error *err)
{
	const uint32_t blocks = s->gather_blocks = s->factors->block_count;
	for (uint32_t k = 0; k < 2; k++) {
		s->gather_sets[k] = calloc(blocks ? blocks : 1, sizeof *s->gather_sets[k]);
		if (!s->gather_sets[k])
			return error_set(err, STATUS_MEMORY, "out of memory");
		enum status status = get_gather(s->device, k == 1, &s->gather[k], err);
		for (uint32_t b = 0; status == STATUS_OK && b < blocks; b++) {
			const struct buffer *buffers[BIND_MOST] = {NULL};
			buffers[BIND_GATHER_COLUMNS] = &s->factors->blocks[b].columns;
			buffers[BIND_GATHER_VALUES] = &s->factors->blocks[b].values;
			buffers[BIND_GATHER_SOURCE] = &s->source;
			buffers[BIND_GATHER_ROWS] = &s->rows;
			buffers[BIND_GATHER_SUMS] = &s->sums;
			status = binding_set_init(&s->gather_sets[k][b], s->device, s->gather[k], buffers, &s->maxima, err);
		}
		if (status != STATUS_OK)
			return status;
	}
	return STATUS_OK;
}

static enum status bind_steps(struct solver *s, struct error *err)
{
	const struct buffer *buffers[BIND_MOST] = {NULL};
	buffers[BIND_STEP_ALBEDO] = &s->albedo;
	buffers[BIND_STEP_EXITANCE] = &s->exitance;
	buffers[BIND_STEP_IRRADIANCE] = &s->irradiance;
	buffers[BIND_STEP_FIELD] = &s->field;
	buffers[BIND_STEP_SOURCE] = &s->source;
	buffers[BIND_STEP_SUMS] = &s->sums;
	buffers[BIND_STEP_RESIDUAL] = &s->residual;
	buffers[BIND_STEP_CHANGE] = &s->change;
	buffers[BIND_STEP_DIRECTION] = &s->direction;
	buffers[BIND_STEP_IMAGE] = &s->image;
	buffers[BIND_STEP_MAXIMA] = &s->maxima;
	buffers[BIND_STEP_PARTS] = &s->partials;
	enum status status = STATUS_OK;
	for (uint32_t i = 0; status == STATUS_OK && i < STEP_COUNT; i++)
		if (has_step(s->way, i)) {
			status = get_step(s->device, i, &s->steps[i], err);
			if (status == STATUS_OK)
				status =
				    binding_set_init(&s->step_sets[i], s->device, s->steps[i], buffers, &s->maxima, err);
		}
	return status;
}

enum status solver_device_init(struct solver *s, const struct solver_problem *problem, struct error *err)
{
	if (2ull * s->count > s->device->limits.maxTexelBufferElements)
		return error_set(err, STATUS_MEMORY, "%u elements are more than this device can bind: use larger patches",
				 s->count);
	enum status status = list_rows(s, problem->which, err);
	if (status == STATUS_OK)
		status = make_buffers(s, problem, err);
	if (status == STATUS_OK)
		status = solver_compile(s->device, s->way, err);
	if (status == STATUS_OK)
		status = bind_gathers(s, err);
	return status == STATUS_OK ? bind_steps(s, err) : status;
}

void solver_device_finish(struct solver *s)
{
	for (uint32_t k = 0; k < 2; k++) {
		for (uint32_t b = 0; s->gather_sets[k] && b < s->gather_blocks; b++)
			binding_set_finish(&s->gather_sets[k][b], s->device);
		free(s->gather_sets[k]);
	}
	for (uint32_t i = 0; i < STEP_COUNT; i++)
		binding_set_finish(&s->step_sets[i], s->device);
	struct buffer *const all[] = {&s->rows,     &s->maxima,     &s->maxima_host, &s->partials, &s->albedo,
				      &s->exitance, &s->irradiance, &s->field,       &s->source,   &s->sums,
				      &s->residual, &s->change,     &s->direction,   &s->image};
	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		buffer_finish(all[i], s->device);
	free(s->list);
	free(s->runs);
}

// ---- recording
// ------------------------------------------------------------------------------------------------------------

void solver_record_step(const struct solver *s, uint32_t step, uint32_t first, uint32_t end, const double scale[4])
{
	VkCommandBuffer c = s->device->commands;
	const struct pipeline *p = s->steps[step];
	struct step_push push = {.end = end};
	for (int i = 0; i < 4; i++)
		push.scale[i] = (float)scale[i];
	vkCmdBindPipeline(c, VK_PIPELINE_BIND_POINT_COMPUTE, p->handle);
	vkCmdBindDescriptorSets(c, VK_PIPELINE_BIND_POINT_COMPUTE, p->layout, 0, 1, &s->step_sets[step].set, 0, NULL);
	while (first < end) {
		const uint32_t groups = (end - first + SOLVE_LANES - 1) / SOLVE_LANES;
		const uint32_t most = groups < GROUPS_MOST ? groups : GROUPS_MOST;
		push.first = first;
		vkCmdPushConstants(c, p->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
		vkCmdDispatch(c, most, 1, 1);
		first += most * SOLVE_LANES;
	}
	command_barrier(s->device);
}

void solver_clear_maxima(const struct solver *s)
{
	vkCmdFillBuffer(s->device->commands, s->maxima.handle, 0, VK_WHOLE_SIZE, 0);
	command_barrier(s->device);
}

void solver_fetch_maxima(const struct solver *s)
{
	const VkBufferCopy region = {.size = s->maxima.bytes};
	vkCmdCopyBuffer(s->device->commands, s->maxima.handle, s->maxima_host.handle, 1, &region);
	command_barrier(s->device);
}

double solver_maximum(const struct solver *s, uint32_t which, int channel)
{
	const float *maxima = s->maxima_host.map;
	return (double)maxima[3 * which + (uint32_t)channel];
}

double solver_sum(const struct solver *s, uint32_t which, int channel)
{
	const float *parts = s->partials.map;
	double sum = 0;
	for (uint32_t i = 0; i < s->partial_count; i++)
		sum += (double)parts[8ull * i + 4ull * which + (uint32_t)channel];
	return sum;
}
