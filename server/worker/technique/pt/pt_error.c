#include "server/worker/technique/pt/pt_error.h"

#include <stdlib.h>

#include "server/base/clock.h"
#include "server/worker/technique/common/resolve.h"
#include "server/worker/technique/pt/pt_job.h"
#include "server/worker/technique/pt/pt_light.h"
#include "server/worker/technique/pt/pt_met.h"
#include "server/worker/technique/pt/pt_relmse.h"
#include "server/worker/vk/command.h"
#include "shaders/error_comp.h"

#define TILES_PER_DISPATCH 32768u // every device takes so many groups

static const struct shader error_shader = {.name = "error",
					   .code = shader_error_comp,
					   .bytes = sizeof shader_error_comp,
					   .bindings = BIND_ERROR_COUNT,
					   .push_bytes = sizeof(struct error_push)};

static enum status bind_band(struct technique_job *j, struct pt_band *band, struct error *err)
{
	const struct buffer *buffers[BIND_MOST] = {NULL};
	buffers[BIND_JOB] = &j->job;
	buffers[BIND_ACCUMULATOR] = &band->accumulator;
	buffers[BIND_ERRORS] = &j->errors;
	buffers[BIND_ERROR_FILM] = &band->film;
	return binding_set_init(&band->error_bindings, j->device, j->error, buffers, &j->counters_host, err);
}

// Record the error of each tile of a band. The tiles before the cursor may have more samples than the others.
static void record(const struct technique_job *j, const struct pt_band *band)
{
	VkCommandBuffer c = j->device->commands;
	const uint32_t even[2] = {(j->plan.first_sample + 1) / 2, j->plan.first_sample / 2};
	const uint32_t last = j->plan.first_sample + j->sample, more = last + (j->tile > 0 ? j->batch : 0);
	struct error_push push = {.first_row = band->first_row,
				  .rows = band->rows,
				  .more_tiles = j->tile,
				  .count_a = (float)((last + 1) / 2 - even[0]),
				  .count_b = (float)(last / 2 - even[1]),
				  .more_a = (float)((more + 1) / 2 - even[0]),
				  .more_b = (float)(more / 2 - even[1]),
				  .has_film = band->film.handle != VK_NULL_HANDLE};
	double units[2];
	pt_light_units(j, band, units);
	push.film_a = (float)units[0];
	push.film_b = (float)units[1];
	vkCmdBindPipeline(c, VK_PIPELINE_BIND_POINT_COMPUTE, j->error->handle);
	vkCmdBindDescriptorSets(c, VK_PIPELINE_BIND_POINT_COMPUTE, j->error->layout, 0, 1, &band->error_bindings.set, 0,
				NULL);
	for (uint32_t tile = 0; tile < band->tiles; tile += TILES_PER_DISPATCH) {
		const uint32_t left = band->tiles - tile;
		push.first_tile = band->first_tile + tile;
		vkCmdPushConstants(c, j->error->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
		vkCmdDispatch(c, left < TILES_PER_DISPATCH ? left : TILES_PER_DISPATCH, 1, 1);
	}
}

static enum status pt_error_run(struct technique_job *j, struct error *err)
{
	enum status s = command_begin(j->device, err);
	if (s != STATUS_OK)
		return s;
	for (uint32_t i = 0; i < j->band_count; i++)
		record(j, &j->bands[i]);
	command_barrier(j->device);
	return command_finish(j->device, err);
}

enum status pt_error_init(struct technique_job *j, struct error *err)
{
	const uint64_t start = clock_us();
	enum status s = pipeline_get(j->device, &error_shader, NULL, &j->error, err);
	if (s == STATUS_OK)
		s = buffer_init(&j->errors, j->device, (uint64_t)j->tiles * sizeof(struct error_tile), BUFFER_DEVICE, err);
	for (uint32_t i = 0; s == STATUS_OK && i < j->band_count; i++)
		s = bind_band(j, &j->bands[i], err);
	j->estimate = ESTIMATE_UNKNOWN;
	if (s != STATUS_OK || j->error->warm)
		return s;
	// A run to make the driver compile: what it writes, of a picture without samples, is not read.
	s = pt_error_run(j, err);
	if (s == STATUS_OK)
		pipeline_has_run(j->device, j->error);
	j->compile_us += clock_us() - start;
	return s;
}

void pt_error_finish(struct technique_job *j)
{
	for (uint32_t i = 0; j->bands && i < j->band_count; i++)
		binding_set_finish(&j->bands[i].error_bindings, j->device);
	buffer_finish(&j->errors, j->device);
}

// Whether a picture without light is as it should be: nothing gives light, or the camera sees no surface.
static enum status is_rightly_black(const struct technique_job *j, bool *rightly, struct error *err)
{
	const uint32_t sources =
	    1u << candil_Effect_EFFECT_EMITTERS | 1u << candil_Effect_EFFECT_LIGHTS | 1u << candil_Effect_EFFECT_ENVIRONMENT;
	uint32_t *met, any = 0;
	*rightly = !(j->plan.effects & sources);
	if (*rightly)
		return STATUS_OK;
	const enum status s = pt_met_read(j, &met, err);
	for (uint64_t i = 0; s == STATUS_OK && i < met_bytes(j->plan.width, j->plan.height) / sizeof *met; i++)
		any |= met[i];
	free(met);
	*rightly = s == STATUS_OK && any == 0;
	return s;
}

static enum status estimate_of(const struct technique_job *j, const struct error_tile *tiles, struct estimate *out,
			       struct error *err)
{
	struct relmse_sums sums = {0};
	bool rightly = false;
	for (uint32_t i = 0; i < j->tiles; i++) {
		sums.terms += tiles[i].terms;
		sums.noise += tiles[i].noise;
		sums.below += tiles[i].below;
		sums.above += tiles[i].above;
		sums.lucky += tiles[i].lucky;
		sums.light += tiles[i].light;
	}
	if (sums.light == 0 && is_rightly_black(j, &rightly, err) != STATUS_OK)
		return err->code;
	*out = rightly ? RELMSE_NONE : relmse_estimate(&sums, (uint64_t)j->plan.width * j->plan.height);
	return STATUS_OK;
}

enum status pt_error_measure(struct technique_job *j, struct error *err)
{
	const uint64_t start = clock_us();
	const size_t bytes = (size_t)j->tiles * sizeof(struct error_tile);
	j->error_sample = j->sample;
	j->estimate = ESTIMATE_UNKNOWN;
	if (j->sample < 2)
		return STATUS_OK;
	struct error_tile *tiles = malloc(bytes);
	if (!tiles)
		return error_set(err, STATUS_MEMORY, "out of memory");
	enum status s = pt_error_run(j, err);
	if (s == STATUS_OK)
		s = buffer_read(&j->errors, j->device, 0, bytes, tiles, err);
	if (s == STATUS_OK)
		s = estimate_of(j, tiles, &j->estimate, err);
	free(tiles);
	j->look_us = clock_us() - start;
	j->error_us += j->look_us;
	return s;
}
