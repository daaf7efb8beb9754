// Makes and frees what a path tracing job needs on the device.
#include <stdlib.h>
#include <string.h>

#include "server/base/checkpoint.h"
#include "server/base/clock.h"
#include "server/worker/technique/common/resolve.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/technique/pt/pt.h"
#include "server/worker/technique/pt/pt_cells.h"
#include "server/worker/technique/pt/pt_error.h"
#include "server/worker/technique/pt/pt_job.h"
#include "server/worker/technique/pt/pt_light.h"
#include "server/worker/technique/pt/pt_light_tree.h"
#include "server/worker/technique/pt/pt_options.h"
#include "server/worker/vk/command.h"
#include "shaders/aov_comp.h"
#include "shaders/path_comp.h"

// Scattering events in one dispatch. Software drivers end an invocation's loops after some 65,000 rounds in all, so sixteen
// events of two rays leave each ray 2,000 rounds.
#define SEGMENT_SOFTWARE 16u

// Samples in a batch, which a lane takes one after the other. The more there are, the less lanes wait for the longest path
// beside theirs, but the longer it is until the next whole picture.
#define BATCH_MOST 16u
#define BATCH_FIRST 2u
#define BATCH_QUICK_US \
	200000.0 // a batch that takes the whole picture less than this may have more samples than all before it

// Loop rounds of an invocation that a batch aims to stay below, where a driver ends loops after 65,535.
#define ROUNDS_SAFE 24000u

static const struct shader path_shader = {.name = "path",
					  .code = shader_path_comp,
					  .bytes = sizeof shader_path_comp,
					  .bindings = BIND_PATH_COUNT,
					  .texels = TRACE_TEXELS | 1u << BIND_LIGHT_NODES,
					  .push_bytes = sizeof(struct path_push)};
static const struct shader aov_shader = {.name = "aov",
					 .code = shader_aov_comp,
					 .bytes = sizeof shader_aov_comp,
					 .bindings = BIND_TRACE_COUNT,
					 .texels = TRACE_TEXELS,
					 .push_bytes = sizeof(struct path_push)};

static uint32_t tiles_of(const struct plan *plan)
{
	return tiles_over(plan->width) * tiles_over(plan->height);
}

static uint64_t pixels_of(const struct plan *plan)
{
	return (uint64_t)plan->width * plan->height;
}

static uint32_t segment_of(const struct device *device, const struct plan *plan)
{
	const uint32_t whole = plan->depth + 1;
	const uint32_t segment = pt_settings(plan)->segment ? pt_settings(plan)->segment
				 : device->info.software    ? SEGMENT_SOFTWARE
							    : whole;
	return segment < whole ? segment : whole;
}

static uint32_t least(uint32_t a, uint32_t b)
{
	return a < b ? a : b;
}

// As many samples as keep lanes busy, but not so many that a preview waits for several times the time so far, nor so many
// that the driver would end loops, judging by the batch before.
void pt_job_next_batch(struct technique_job *j)
{
	const uint32_t grown = j->sample > BATCH_FIRST ? j->sample : BATCH_FIRST;
	const double one_us = j->tile_us * j->tiles;
	uint32_t batch = grown;
	if (j->tile_us > 0 && BATCH_QUICK_US / one_us > grown)
		batch = BATCH_QUICK_US / one_us < BATCH_MOST ? (uint32_t)(BATCH_QUICK_US / one_us) : BATCH_MOST;
	if (j->device->info.software && j->loop_rounds > 0) {
		const uint64_t safe = (uint64_t)ROUNDS_SAFE * j->batch / j->loop_rounds;
		batch = safe < batch ? (uint32_t)safe : batch;
	}
	if (pt_settings(&j->plan)->batch)
		batch = pt_settings(&j->plan)->batch;
	batch = least(least(batch, j->batch_most), j->plan.samples - j->sample);
	if (j->plan.target_error > 0)
		batch = least(batch, checkpoint_after(j->sample) - j->sample);
	if (j->plan.deadline && j->sample == 0)
		batch = 1;
	j->batch = batch > 0 ? batch : 1;
	j->loop_rounds = 0;
}

static uint64_t paths_bytes(const struct plan *plan)
{
	const uint32_t tiles = tiles_of(plan) < PT_TILES_PER_DISPATCH ? tiles_of(plan) : PT_TILES_PER_DISPATCH;
	return (uint64_t)tiles * TILE_PIXELS * sizeof(struct path_state);
}

uint64_t pt_job_bytes(const struct devices *devices, struct resident_scene *scene, const struct plan *plan)
{
	uint64_t bytes = sizeof(struct scene_params) + 2 * sizeof(struct pass_counters);
	bytes += met_bytes(plan->width, plan->height);
	if (segment_of(devices->vk, plan) <= plan->depth)
		bytes += paths_bytes(plan);
	if (pt_cells_wanted(scene, plan))
		bytes += pt_cells_bytes(scene);
	if (pt_light_tree_wanted(devices, scene, plan))
		bytes += pt_light_tree_bytes(scene, plan);
	if (plan_has_sky(plan))
		bytes += (uint64_t)plan->environment.width * plan->environment.height *
			 (sizeof(struct environment_texel) + sizeof(struct environment_row));
	bytes += tiles_of(plan) * sizeof(struct error_tile);
	bytes += pixels_of(plan) * ACCUMULATOR_FLOATS * sizeof(float);
	if (plan->aovs)
		bytes += pixels_of(plan) * AOV_WORDS * sizeof(uint32_t);
	return bytes + pt_light_bytes(&scene->view, plan);
}

// ---- bands --------------------------------------------------------------------------------------------------------------

// Cut the image into as few bands of whole tile rows as the device's largest binding allows.
static enum status pt_cut_bands(struct technique_job *j, struct error *err)
{
	const struct plan *p = &j->plan;
	const uint64_t row_bytes = (uint64_t)p->width * TILE_SIDE * ACCUMULATOR_FLOATS * sizeof(float);
	const uint64_t fit = j->device->limits.maxStorageBufferRange / row_bytes;
	const uint32_t all = tiles_over(p->height);
	if (fit == 0)
		return error_set(err, STATUS_MEMORY, "this device cannot bind eight rows of %u pixels: render narrower",
				 p->width);
	const uint32_t tile_rows = fit < all ? (uint32_t)fit : all;
	j->band_count = (all + tile_rows - 1) / tile_rows;
	j->bands = calloc(j->band_count, sizeof *j->bands);
	if (!j->bands)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; i < j->band_count; i++) {
		struct pt_band *b = &j->bands[i];
		const uint32_t first = i * tile_rows, rows = all - first < tile_rows ? all - first : tile_rows;
		b->first_row = first * TILE_SIDE;
		b->rows = b->first_row + rows * TILE_SIDE <= p->height ? rows * TILE_SIDE : p->height - b->first_row;
		b->first_tile = first * tiles_over(p->width);
		b->tiles = rows * tiles_over(p->width);
	}
	return STATUS_OK;
}

struct pt_band *pt_job_band(const struct technique_job *j, uint32_t tile)
{
	struct pt_band *b = j->bands;
	while (tile >= b->first_tile + b->tiles)
		b++;
	return b;
}

static enum status clear_bands(struct technique_job *j, struct error *err)
{
	enum status s = buffer_clear(&j->counters, j->device, err);
	for (uint32_t i = 0; s == STATUS_OK && i < j->band_count; i++) {
		s = buffer_clear(&j->bands[i].accumulator, j->device, err);
		if (s == STATUS_OK && j->bands[i].film.handle)
			s = buffer_clear(&j->bands[i].film, j->device, err);
	}
	return s;
}

static enum status pt_make_buffers(struct technique_job *j, struct error *err)
{
	struct device *d = j->device;
	struct scene_params params;
	scene_params_fill(&j->plan, &j->scene->view, plan_has_sky(&j->plan), &params);
	pt_options_fill(pt_settings(&j->plan), &params);
	if (j->cells)
		params.emitter_power_inv = scene_power_inverse(j->cells->tables.power);
	enum status s = pt_light_init(j, &params, err);
	if (s == STATUS_OK)
		s = buffer_init_with(&j->job, d, &params, sizeof params, err);
	if (s == STATUS_OK)
		s = buffer_init(&j->counters, d, sizeof(struct pass_counters) + met_bytes(j->plan.width, j->plan.height),
				BUFFER_DEVICE, err);
	if (s == STATUS_OK)
		s = buffer_init(&j->counters_host, d, sizeof(struct pass_counters), BUFFER_READBACK, err);
	for (uint32_t i = 0; s == STATUS_OK && i < j->band_count; i++) {
		struct pt_band *b = &j->bands[i];
		const uint64_t pixels = (uint64_t)b->rows * j->plan.width;
		s = buffer_init(&b->accumulator, d, pixels * ACCUMULATOR_FLOATS * sizeof(float), BUFFER_DEVICE, err);
		if (s == STATUS_OK && j->plan.aovs)
			s = buffer_init(&b->aov, d, pixels * AOV_WORDS * sizeof(uint32_t), BUFFER_DEVICE, err);
		if (s == STATUS_OK && j->plan.aovs)
			s = buffer_clear(&b->aov, d, err);
	}
	return s == STATUS_OK ? clear_bands(j, err) : s;
}

// ---- pipelines ----------------------------------------------------------------------------------------------------------

enum status pt_job_pipeline(struct technique_job *j, uint32_t effects, struct pipeline **pipeline, struct binding_set *set,
			    struct error *err)
{
	enum status s = STATUS_OK;
	if (j->plan.environment.power > 0 && effects >> candil_Effect_EFFECT_ENVIRONMENT & 1u)
		s = sky_texels_get(j->plan.environment.scene, j->device, &j->sky, err);
	if (s == STATUS_OK)
		s = pt_job_make_pipeline(j, &path_shader, effects, pipeline, err);
	if (s == STATUS_OK)
		s = pt_job_bind(j, *pipeline, &j->bands[0].accumulator, set, err);
	return s == STATUS_OK ? pt_job_warm_up(j, *pipeline, set, err) : s;
}

static enum status make_path_pass(struct technique_job *j, uint32_t segment, struct error *err)
{
	const uint64_t start = clock_us();
	enum status s = STATUS_OK;
	j->segment = segment;
	j->segments = (j->plan.depth + segment) / segment; // (depth + 1) / segment, rounded up
	if (j->segments > 1 && !j->paths.handle)
		s = buffer_init(&j->paths, j->device, paths_bytes(&j->plan), BUFFER_DEVICE, err);
	if (s == STATUS_OK)
		s = pt_job_make_pipeline(j, &path_shader, j->plan.effects, &j->path, err);
	for (uint32_t i = 0; s == STATUS_OK && i < j->band_count; i++) {
		binding_set_finish(&j->bands[i].path_bindings, j->device);
		s = pt_job_bind(j, j->path, &j->bands[i].accumulator, &j->bands[i].path_bindings, err);
	}
	bool compiles = s == STATUS_OK && !j->path->warm;
	if (s == STATUS_OK)
		s = pt_job_warm_up(j, j->path, &j->bands[0].path_bindings, err);
	if (s == STATUS_OK)
		s = pt_light_make_pass(j, &compiles, err);
	if (compiles)
		j->compile_us += clock_us() - start;
	return s;
}

static enum status make_aov_pass(struct technique_job *j, struct error *err)
{
	const uint64_t start = clock_us();
	enum status s = pt_job_make_pipeline(j, &aov_shader, j->plan.effects, &j->aov, err);
	for (uint32_t i = 0; s == STATUS_OK && i < j->band_count; i++)
		s = pt_job_bind(j, j->aov, &j->bands[i].aov, &j->bands[i].aov_bindings, err);
	const bool compiles = s == STATUS_OK && !j->aov->warm;
	if (s == STATUS_OK)
		s = pt_job_warm_up(j, j->aov, &j->bands[0].aov_bindings, err);
	if (compiles)
		j->compile_us += clock_us() - start;
	return s;
}

// ---- the job ------------------------------------------------------------------------------------------------------------

enum status pt_job_create(struct devices *devices, struct resident_scene *scene, const struct plan *plan,
			  struct technique_job **job, struct error *err)
{
	struct device *device = devices->vk;
	struct technique_job *j = calloc(1, sizeof *j);
	if (!j)
		return error_set(err, STATUS_MEMORY, "out of memory");
	j->device = device;
	j->scene = scene;
	j->plan = *plan;
	j->tiles = tiles_of(plan);
	j->batch_most = pt_settings(plan)->batch ? pt_settings(plan)->batch : BATCH_MOST;
	const uint64_t start = clock_us();
	enum status s = resident_upload(scene, device, scene_bindings_shade(plan) | TRACE_BINDINGS, err);
	if (s == STATUS_OK)
		j->trace = trace_choose(device, scene, (enum trace_way)pt_settings(plan)->traversal);
	if (s == STATUS_OK && plan_has_sky(plan))
		s = sky_texels_get(plan->environment.scene, device, &j->sky, err);
	if (s == STATUS_OK && pt_cells_wanted(scene, plan))
		s = pt_cells_get(device, scene, &j->cells, err);
	if (s == STATUS_OK)
		s = pt_cut_bands(j, err);
	if (s == STATUS_OK)
		s = pt_make_buffers(j, err);
	j->upload_us = clock_us() - start;
	if (s == STATUS_OK && pt_light_tree_wanted(devices, scene, plan))
		s = pt_light_tree_get(device, scene, plan, j->cells ? &j->cells->tables : NULL, &j->tree, &j->tree_us, err);
	if (s == STATUS_OK)
		s = make_path_pass(j, segment_of(device, plan), err);
	if (s == STATUS_OK && plan->aovs)
		s = make_aov_pass(j, err);
	if (s == STATUS_OK)
		s = pt_error_init(j, err);
	if (s != STATUS_OK) {
		pt_job_destroy(j);
		return s;
	}
	pt_job_next_batch(j);
	*job = j;
	return STATUS_OK;
}

enum status pt_job_restart(struct technique_job *j, uint32_t segment, uint32_t batch, struct error *err)
{
	j->batch_most = batch;
	j->sample = 0;
	j->tile = 0;
	j->seen = (struct pass_counters){0};
	j->rays = 0;
	j->non_finite = 0;
	j->clamped = 0;
	j->removed = 0;
	j->loop_rounds = 0;
	j->error_sample = 0;
	j->estimate = ESTIMATE_UNKNOWN;
	pt_job_next_batch(j);
	enum status s = make_path_pass(j, segment, err);
	return s == STATUS_OK ? clear_bands(j, err) : s;
}

void pt_job_destroy(struct technique_job *j)
{
	if (!j)
		return;
	pt_error_finish(j);
	pt_light_finish(j);
	for (uint32_t i = 0; j->bands && i < j->band_count; i++) {
		struct pt_band *b = &j->bands[i];
		binding_set_finish(&b->path_bindings, j->device);
		binding_set_finish(&b->aov_bindings, j->device);
		buffer_finish(&b->accumulator, j->device);
		buffer_finish(&b->aov, j->device);
	}
	free(j->bands);
	buffer_finish(&j->job, j->device);
	buffer_finish(&j->counters, j->device);
	buffer_finish(&j->counters_host, j->device);
	buffer_finish(&j->paths, j->device);
	free(j);
}
