// Internal to the path tracer: its job on a device. pt_setup.c makes and frees it, pt_pipeline.c makes its pipelines, pt.c
// runs it. Device's thread only. Times are microseconds.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_JOB_H
#define CANDIL_WORKER_TECHNIQUE_PT_JOB_H

#include "server/base/estimate.h"
#include "server/worker/devices.h"
#include "server/worker/plan/plan.h"
#include "server/worker/scenes/resident.h"
#include "server/worker/technique/common/sky_texels.h"
#include "server/worker/trace/trace.h"
#include "server/worker/vk/pipeline.h"
#include "shaders/shared/pt.h"
#include "shaders/shared/scene_params.h"

// A band: rows of the image whose sums fit one buffer that the device can bind. Most images are one band.
struct pt_band {
	uint32_t first_row, rows; // pixels; first_row is a multiple of TILE_SIDE
	uint32_t first_tile, tiles;
	struct buffer accumulator;
	struct buffer aov; // only if asked for
	struct buffer film; // what light paths bring: struct film_pixel; only with light paths
	struct binding_set path_bindings;
	struct binding_set aov_bindings;
	struct binding_set error_bindings;
	struct binding_set light_bindings;
};

// The job.
struct technique_job {
	struct device *device;
	struct resident_scene *scene;
	struct plan plan;
	struct trace trace; // the traversal of its rays
	const struct sky_texels *sky; // the environment on the device, its scene's; NULL: not needed
	uint32_t tiles; // of the image
	uint32_t segment; // the most scattering events in a dispatch, for each of its samples
	uint32_t segments; // dispatches that a batch takes
	uint32_t batch_most; // the most samples in a batch
	const struct pt_cells *cells; // of textured emissive triangles, the scene's; NULL: there are none
	const struct pt_light_tree *tree; // the tree over lamps, the scene's; NULL: lamps are chosen by power
	struct buffer job; // struct scene_params
	struct buffer counters; // struct pass_counters, growing, and the bits of pixels that met a surface
	struct buffer counters_host; // a copy of them after the last submission
	struct buffer paths; // only if segments > 1
	struct pipeline *path;
	struct pipeline *aov; // only if asked for
	struct pipeline *error;
	struct pipeline *light; // only with light paths
	struct buffer casters; // struct emitter: the alias table over polished triangles; only if there are any
	struct buffer caster_density; // a float for each material; only with light paths
	double film_unit; // as in struct scene_params
	struct buffer errors; // struct error_tile a tile
	struct pt_band *bands;
	uint32_t band_count;

	// The cursor. A batch is the next few samples of every pixel.
	uint32_t sample; // the samples before it, counted from first_sample, are complete
	uint32_t batch; // samples in the batch
	uint32_t tile; // next of the batch
	uint32_t loop_rounds; // the most loop rounds of an invocation in this batch's dispatches
	uint32_t aov_tile; // next of the AOVs
	double tile_us; // measured time of one sample of a tile; 0: not yet
	struct pass_counters seen; // the counters when they were last read
	uint64_t rays, non_finite, clamped; // rays traced; samples that were not finite, and that were clamped
	uint64_t removed; // luminance that clamping removed, in units of the clamp / CLAMP_UNITS
	struct estimate estimate; // of the picture after error_sample samples
	uint32_t error_sample;
	uint64_t error_us; // spent on measuring it
	uint64_t look_us; // the latest time
	uint64_t upload_us, tree_us, compile_us, effects_us, trace_us, light_us, aov_us;
};

#define PT_TILES_PER_DISPATCH 4096u

// struct technique's `bytes`.
uint64_t pt_job_bytes(const struct devices *devices, struct resident_scene *scene, const struct plan *plan);

// struct technique's `begin`.
enum status pt_job_create(struct devices *devices, struct resident_scene *scene, const struct plan *plan,
			  struct technique_job **job, struct error *err);

// struct technique's `end`.
void pt_job_destroy(struct technique_job *job);

// The compiled pipeline that traces paths with these effects (bits 1 << candil_Effect), and its bindings for the first band.
// The pipeline is the device's; the caller finishes the set. STATUS_MEMORY, STATUS_DEVICE, as the three below.
enum status pt_job_pipeline(struct technique_job *job, uint32_t effects, struct pipeline **pipeline, struct binding_set *set,
			    struct error *err);

// The pipeline of a shader with these effects and the job's ways of sampling. It may not have run yet.
enum status pt_job_make_pipeline(struct technique_job *job, const struct shader *shader, uint32_t effects,
				 struct pipeline **pipeline, struct error *err);

// Bind the buffers of a pipeline that traces, for a band. `result` is bound at BIND_ACCUMULATOR, which is BIND_AOV and
// BIND_FILM too.
enum status pt_job_bind(struct technique_job *job, struct pipeline *pipeline, const struct buffer *result,
			struct binding_set *set, struct error *err);

// Run a pipeline once over nothing unless it is warm, so that the driver compiles it now and not in some slice.
enum status pt_job_warm_up(struct technique_job *job, struct pipeline *pipeline, const struct binding_set *set,
			   struct error *err);

// What all passes over a band tell their shader about the batch at the cursor. The caller adds which tiles.
struct path_push pt_job_push(const struct technique_job *job, const struct pt_band *band);

// Record so many dispatches of one pass over push.tile_count workgroups, each continuing the paths of the one before.
// Between command_begin and command_finish.
void pt_job_record(const struct technique_job *job, const struct pipeline *pipeline, const struct binding_set *set,
		   struct path_push push, uint32_t dispatches);

// Begin the image again, with dispatches of at most `segment` events and batches of at most `batch` samples. Forgets what
// has been summed. STATUS_MEMORY, STATUS_DEVICE.
enum status pt_job_restart(struct technique_job *job, uint32_t segment, uint32_t batch, struct error *err);

// Choose the number of samples in the batch at the cursor.
void pt_job_next_batch(struct technique_job *job);

// The band that holds a tile.
struct pt_band *pt_job_band(const struct technique_job *job, uint32_t tile);

#endif
