// Runs the path tracer's job: a cursor over batches of samples and their tiles, in slices.
//
// A slice is one or more submissions. Each takes as many tiles of one batch as should fit the rest of the budget by the
// speed measured so far. Where a slice or a batch ends changes no bit, because a pixel's samples are added in the order of
// their index, and the paths of a tile are independent of other tiles.
#include "server/worker/technique/pt/pt.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/checkpoint.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/base/luminance.h"
#include "server/worker/image/frame.h"
#include "server/worker/technique/common/resolve.h"
#include "server/worker/technique/pt/pt_effects.h"
#include "server/worker/technique/pt/pt_error.h"
#include "server/worker/technique/pt/pt_job.h"
#include "server/worker/technique/pt/pt_light.h"
#include "server/worker/technique/pt/pt_met.h"
#include "server/worker/technique/pt/pt_options.h"
#include "server/worker/vk/command.h"

#define DISPATCHES_PER_SUBMIT 256u
#define FIRST_TILES 16u
#define FIRST_TILES_TIMED 4u // with a deadline, which they may not overrun by more than about a tile's time
#define LOOKS_SHARE 50u // the time of tracing over that of looks at the error, for progress alone
#define AOV_TILES 16u // AOVs take one ray a pixel and a path many, so about so many times the tiles take the same time

// How many of the `count` tiles from `tile` on one dispatch can take: those within the band, up to a limit.
static uint32_t run_of_tiles(const struct pt_band *band, uint32_t tile, uint64_t count)
{
	const uint32_t left = band->first_tile + band->tiles - tile;
	const uint32_t most = left < PT_TILES_PER_DISPATCH ? left : PT_TILES_PER_DISPATCH;
	return count < most ? (uint32_t)count : most;
}

// Record about `count` single samples of tiles from the cursor on, of one batch, and move the cursor. Returns how many were
// recorded.
static uint64_t record_paths(struct technique_job *j, uint64_t count)
{
	uint64_t recorded = 0;
	for (uint32_t n = 0; n < DISPATCHES_PER_SUBMIT && recorded < count && j->tile < j->tiles; n += j->segments) {
		const struct pt_band *band = pt_job_band(j, j->tile);
		const uint64_t tiles = (count - recorded) / j->batch;
		struct path_push push = pt_job_push(j, band);
		push.first_tile = j->tile;
		push.tile_count = run_of_tiles(band, j->tile, tiles > 0 ? tiles : 1);
		pt_job_record(j, j->path, &band->path_bindings, push, j->segments);
		recorded += (uint64_t)push.tile_count * j->batch;
		j->tile += push.tile_count;
	}
	return recorded;
}

// If the last tile of the batch has been done, count its samples as complete.
static void end_batch(struct technique_job *j)
{
	if (j->tile < j->tiles)
		return;
	j->tile = 0;
	j->sample += j->batch;
	if (j->sample < j->plan.samples)
		pt_job_next_batch(j);
}

static void record_aov(struct technique_job *j, uint64_t count)
{
	const struct pt_band *band = pt_job_band(j, j->aov_tile);
	const struct path_push push = {
	    .first_tile = j->aov_tile, .tile_count = run_of_tiles(band, j->aov_tile, count), .first_row = band->first_row};
	pt_job_record(j, j->aov, &band->aov_bindings, push, 1);
	j->aov_tile += push.tile_count;
}

// The driver ended a loop early, so the sums lack something: begin again with shorter dispatches.
static enum status on_cut(struct technique_job *j, struct error *err)
{
	if (j->batch > 1 && !pt_settings(&j->plan)->batch) {
		log_line(LOG_WARNING, "the driver ended a loop early: going on with %u samples a dispatch", j->batch / 2);
		return pt_job_restart(j, j->segment, j->batch / 2, err);
	}
	if (j->segment == 1)
		return error_set(
		    err, STATUS_TRAVERSAL_CUT,
		    "one ray visits more of this scene than the driver lets a loop run: split long thin triangles, or use "
		    "a GPU or a newer driver");
	if (pt_settings(&j->plan)->segment)
		return error_set(err, STATUS_TRAVERSAL_CUT,
				 "the driver ended a loop of the path tracer early: leave pt.segment out or set it below %u",
				 j->segment);
	log_line(LOG_WARNING, "the driver ended a loop early: going on with %u events a dispatch", j->segment / 2);
	return pt_job_restart(j, j->segment / 2, j->batch_most, err);
}

static enum status pt_take_counters(struct technique_job *j, struct error *err)
{
	struct pass_counters now;
	memcpy(&now, j->counters_host.map, sizeof now);
	j->rays += now.rays - j->seen.rays; // modulo 2^32, which no submission reaches
	j->non_finite += now.non_finite - j->seen.non_finite;
	j->clamped += now.clamped - j->seen.clamped;
	j->removed = (uint64_t)now.removed[1] << 32 | now.removed[0];
	j->seen = now;
	if (now.loop_rounds > j->loop_rounds)
		j->loop_rounds = now.loop_rounds;
	return now.cut ? on_cut(j, err) : STATUS_OK;
}

// Run what is recorded, and add the time that it took to *us.
static enum status pt_finish(struct technique_job *j, uint64_t *us, struct error *err)
{
	struct device *d = j->device;
	const VkBufferCopy all = {.size = sizeof(struct pass_counters)};
	vkCmdCopyBuffer(d->commands, j->counters.handle, j->counters_host.handle, 1, &all);
	command_barrier(d);
	const uint64_t start = clock_us();
	const enum status s = command_finish(d, err);
	*us += clock_us() - start;
	return s;
}

// Run the light paths of the tiles from `first_tile` to the cursor, whose camera paths have just run. They are a submission
// of their own, so that their time is known.
static enum status submit_lights(struct technique_job *j, uint32_t first_tile, uint64_t *us, struct error *err)
{
	const uint64_t before = *us;
	enum status s = command_begin(j->device, err);
	if (s != STATUS_OK)
		return s;
	for (uint32_t tile = first_tile; tile < j->tile;) {
		const struct pt_band *band = pt_job_band(j, tile);
		const uint32_t count = run_of_tiles(band, tile, j->tile - tile);
		pt_light_record(j, j->light, &band->light_bindings, band, tile, count);
		tile += count;
	}
	s = pt_finish(j, us, err);
	j->light_us += *us - before;
	return s;
}

static enum status submit(struct technique_job *j, uint64_t count, struct error *err)
{
	struct device *d = j->device;
	const bool aov = j->plan.aovs && j->aov_tile < j->tiles;
	uint64_t recorded = 0;
	enum status s = command_begin(d, err);
	if (s != STATUS_OK)
		return s;
	// loop_rounds is the maximum of one submission; all other counters grow.
	vkCmdFillBuffer(d->commands, j->counters.handle, offsetof(struct pass_counters, loop_rounds), sizeof(uint), 0);
	command_barrier(d);
	const uint32_t first_tile = j->tile;
	if (aov)
		record_aov(j, AOV_TILES * count);
	else
		recorded = record_paths(j, count);
	uint64_t us = 0;
	s = pt_finish(j, &us, err);
	if (s != STATUS_OK)
		return s;
	if (aov) {
		j->aov_us += us;
		return STATUS_OK;
	}
	j->trace_us += us;
	if (j->light) {
		s = submit_lights(j, first_tile, &us, err);
		if (s != STATUS_OK)
			return s;
	}
	const double measured = (double)us / (double)recorded;
	j->tile_us = j->tile_us > 0 ? 0.5 * (j->tile_us + measured) : measured;
	s = pt_take_counters(j, err);
	if (s == STATUS_OK)
		end_batch(j);
	return s;
}

// Whether the target error is reached, by the upper end of the interval. Asked only where a batch ends at one of the fixed
// checkpoints.
static enum status look_at_target(struct technique_job *j, bool *reached, struct error *err)
{
	*reached = false;
	// The last look is the picture's own.
	if (!plan_fits(&j->plan, clock_us(), (double)j->look_us))
		return STATUS_OK;
	if (!(j->plan.target_error > 0) || j->tile > 0 || j->sample == 0 || checkpoint_after(j->sample - 1) != j->sample)
		return STATUS_OK;
	enum status s = j->error_sample == j->sample ? STATUS_OK : pt_error_measure(j, err);
	*reached = j->estimate.high >= 0 && j->estimate.high <= j->plan.target_error;
	return s;
}

// Measure the error for the progress report, each time the number of samples has doubled, if that takes a small share of the
// job's time. No bit of the picture depends on it.
static enum status look_at_error(struct technique_job *j, struct error *err)
{
	const bool due =
	    j->sample >= 2 && j->sample / 2 >= j->error_sample && plan_fits(&j->plan, clock_us(), (double)j->look_us);
	return due && LOOKS_SHARE * j->error_us <= j->trace_us ? pt_error_measure(j, err) : STATUS_OK;
}

// The share of the work that is done: by samples, or by the target error if that is nearer. relMSE falls as 1 / samples.
static double fraction_of(const struct technique_job *j, bool reached)
{
	const double samples = ((double)j->sample + (double)j->batch * j->tile / j->tiles) / j->plan.samples;
	const double error = j->estimate.high > 0 ? j->plan.target_error / j->estimate.high : 0;
	return reached ? 1 : fmin(fmax(samples, error), 1);
}

// Whether there is no time for another piece before the end. A piece is a tile at least, which one processor of several
// takes by itself.
static bool pt_is_late(const struct technique_job *j)
{
	return (j->sample > 0 || !j->plan.first_sure) && !plan_fits(&j->plan, clock_us(), 2 * j->tile_us * j->batch);
}

static enum status pt_step(struct technique_job *j, uint32_t budget_us, struct step_result *result, struct error *err)
{
	const uint64_t start = clock_us();
	uint64_t spent = 0;
	bool reached = false;
	while (j->sample < j->plan.samples && !pt_is_late(j)) {
		const double left_us = (double)(budget_us - spent);
		const double piece_us = plan_piece_us(&j->plan, start + spent, left_us);
		const uint64_t first = j->plan.end_us > 0 ? FIRST_TILES_TIMED : FIRST_TILES;
		uint64_t tiles = j->tile_us > 0 ? (uint64_t)(piece_us / j->tile_us) : first;
		enum status s = submit(j, tiles > 0 ? tiles : 1, err);
		if (s == STATUS_OK)
			s = look_at_target(j, &reached, err);
		if (s != STATUS_OK)
			return s;
		if (reached || (j->plan.deadline && j->sample == 1 && j->tile == 0))
			break;
		spent = clock_us() - start;
		// What is left of the budget is less than another tile takes.
		if (spent >= budget_us || (double)(budget_us - spent) < j->tile_us * j->batch)
			break;
	}
	result->samples_done = j->sample;
	result->reached = reached;
	result->finished = reached || j->sample == j->plan.samples;
	const enum status s = look_at_error(j, err);
	result->late = !result->finished && pt_is_late(j);
	result->drawing = true;
	result->sample_us = j->sample > 0 ? (double)(j->aov_us + j->trace_us + j->light_us) / j->sample : 0;
	result->estimate = j->estimate;
	result->fraction = fraction_of(j, reached);
	return s;
}

// ---- read ---------------------------------------------------------------------------------------------------------------

static enum status pt_read_band(struct technique_job *j, const struct pt_band *b, struct resolver *resolver, struct frame *f,
				struct error *err)
{
	const size_t bytes = (size_t)b->accumulator.bytes;
	void *host = malloc(bytes);
	if (!host)
		return error_set(err, STATUS_MEMORY, "out of memory");
	uint32_t *film = NULL;
	enum status s = buffer_read(&b->accumulator, j->device, 0, bytes, host, err);
	if (s == STATUS_OK)
		s = pt_light_read(j, b, &film, err);
	resolver->film = film;
	pt_light_units(j, b, resolver->film_units);
	if (s == STATUS_OK)
		resolve_sums(resolver, host, b->first_row, b->rows, f);
	free(film);
	if (s == STATUS_OK && b->aov.bytes > 0) {
		// AOVs need less room than the sums did, which are read by now.
		s = buffer_read(&b->aov, j->device, 0, b->aov.bytes, host, err);
		if (s == STATUS_OK)
			resolve_aovs(host, b->first_row, b->rows, f);
	}
	free(host);
	return s;
}

static enum status read_met(const struct technique_job *j, struct frame *f, struct error *err)
{
	uint32_t *met;
	const enum status s = pt_met_read(j, &met, err);
	if (s == STATUS_OK)
		resolve_met(met, f);
	free(met);
	return s;
}

// Report the bias that clamping causes in the mean luminance of the picture.
static void account_clamp(const struct technique_job *j, struct frame *f)
{
	const uint64_t pixels = (uint64_t)f->width * f->height;
	const double samples = (double)pixels * ((double)j->sample + (double)j->batch * j->tile / j->tiles);
	const double removed = (double)j->removed / CLAMP_UNITS * (double)pt_settings(&j->plan)->clamp / samples;
	double kept = 0;
	for (uint64_t i = 0; i < pixels; i++)
		kept += luminance(&f->radiance[3 * i]);
	kept /= (double)pixels;
	frame_add_figure(f, "clamp.samples", (double)j->clamped, "");
	frame_add_figure(f, "clamp.removed", removed, "W/(m² sr)");
	frame_add_figure(f, "clamp.share", removed > 0 ? removed / (removed + kept) : 0, "");
}

// Say why the error is not known, or has no upper end.
static void note_estimate(const struct technique_job *j, struct frame *f)
{
	const char *end = j->plan.target_error > 0 ? ", and no target is known to be reached" : "";
	if (j->error_sample == 0 || j->estimate.high >= 0)
		return;
	if (j->sample < 2)
		frame_add_note(f, "one sample cannot tell its error%s", end);
	else if (j->estimate.relmse < 0)
		frame_add_note(f, "no sample has found light, though the scene gives some: the error is not known%s", end);
	else
		frame_add_note(
		    f, "most light came to few pixels by luck, and as much may be missing: the error has no upper end%s",
		    end);
}

static void pt_account(const struct technique_job *j, struct frame *f)
{
	f->samples = j->sample;
	f->ahead = j->sample == 0 ? j->tile : 0;
	f->estimate = j->estimate;
	note_estimate(j, f);
	f->non_finite_samples = j->non_finite;
	f->rays = j->rays;
	if (j->upload_us)
		frame_add_stage(f, "upload", j->upload_us);
	if (j->tree_us > 0)
		frame_add_stage(f, "light-tree", j->tree_us);
	if (j->compile_us)
		frame_add_stage(f, "compile", j->compile_us);
	if (j->effects_us)
		frame_add_stage(f, "effects", j->effects_us);
	if (j->plan.aovs)
		frame_add_stage(f, "aov", j->aov_us);
	frame_add_stage(f, "trace", j->trace_us);
	if (j->light)
		frame_add_stage(f, "caustics", j->light_us);
	if (j->error_us)
		frame_add_stage(f, "error", j->error_us);
}

static enum status pt_read(struct technique_job *j, struct frame **frame, struct error *err)
{
	struct frame *f;
	const uint64_t start = clock_us(), error_us = j->error_us;
	enum status s = frame_create(j->plan.width, j->plan.height, j->plan.aovs, &f, err);
	if (s != STATUS_OK)
		return s;
	struct resolver resolver;
	resolver_init(&resolver, j->plan.first_sample, j->sample, j->tile, j->batch);
	for (uint32_t i = 0; s == STATUS_OK && i < j->band_count; i++)
		s = pt_read_band(j, &j->bands[i], &resolver, f, err);
	if (s == STATUS_OK && j->sample > 0 && (j->error_sample != j->sample || j->tile > 0))
		s = pt_error_measure(j, err);
	if (s == STATUS_OK)
		s = read_met(j, f, err);
	if (s != STATUS_OK) {
		frame_destroy(f);
		return s;
	}
	pt_account(j, f);
	if (pt_settings(&j->plan)->clamp > 0)
		account_clamp(j, f);
	frame_add_stage(f, "resolve", clock_us() - start - (j->error_us - error_us));
	*frame = f;
	return STATUS_OK;
}

static uint32_t pt_depth(const struct plan *plan)
{
	return pt_settings(plan)->depth;
}

const struct technique technique_pt = {.number = candil_Technique_TECHNIQUE_PT,
				       .options = pt_options,
				       .needs = pt_needs,
				       .defaults = pt_options_default,
				       .depth = pt_depth,
				       .effects = UINT32_MAX,
				       .bytes = pt_job_bytes,
				       .begin = pt_job_create,
				       .time_effects = pt_time_effects,
				       .step = pt_step,
				       .read = pt_read,
				       .end = pt_job_destroy};
