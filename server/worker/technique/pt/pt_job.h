// Inside the path tracer: its job on a device. pt_setup.c makes and frees it, pt.c runs it.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_JOB_H
#define CANDIL_WORKER_TECHNIQUE_PT_JOB_H

#include "server/worker/devices.h"
#include "server/worker/plan/plan.h"
#include "server/worker/scenes/resident.h"
#include "server/worker/technique/pt/pt_sky.h"
#include "server/worker/trace/trace.h"
#include "server/worker/vk/pipeline.h"
#include "shaders/shared/pt.h"
#include "shaders/shared/scene_params.h"

// Rows of the image whose sums fit one buffer that the device can bind. Most images are one band.
struct pt_band {
	uint32_t first_row, rows; // pixels; first_row is a multiple of TILE_SIDE
	uint32_t first_tile, tiles;
	struct buffer accumulator;
	struct buffer aov; // only if asked for
	struct buffer film; // struct film_pixel; only with light paths
	struct binding_set path_bindings;
	struct binding_set aov_bindings;
	struct binding_set error_bindings;
	struct binding_set light_bindings;
};

struct technique_job {
	struct device *device;
	struct resident_scene *scene;
	struct plan plan;
	struct trace trace; // how its rays walk
	const struct pt_sky *sky; // of the picture around the scene, on the device; NULL: not needed
	uint32_t tiles;
	uint32_t segment; // scattering events in a dispatch at most, for each of its samples
	uint32_t segments; // dispatches that a batch takes
	uint32_t batch_most; // samples of a batch at most
	const struct pt_light_tree *tree; // the tree over lamps, the scene's; NULL: they are chosen by power
	struct buffer job; // struct scene_params
	struct buffer counters; // struct pass_counters, growing
	struct buffer counters_host; // what the last submission left in them
	struct buffer paths; // only if segments > 1
	struct pipeline *path;
	struct pipeline *aov; // only if asked for
	struct pipeline *error;
	struct pipeline *light; // only with light paths
	struct buffer casters; // struct emitter; only if there are any
	struct buffer caster_density; // a float a material; only with light paths
	double film_unit; // scene_params's
	struct buffer errors; // a float a tile
	struct pt_band *bands;
	uint32_t band_count;

	// The cursor: a batch is the next few samples of every pixel; next to do of it is tile `tile`.
	uint32_t sample; // those before it, counted from first_sample, are complete
	uint32_t batch; // samples in it
	uint32_t tile;
	uint32_t loop_rounds; // the most that an invocation went round in this batch's dispatches
	uint32_t aov_tile;
	double tile_us; // measured time of a tile of one sample; 0: not yet
	struct pass_counters seen; // counters at the last look
	uint64_t rays, non_finite, clamped;
	uint64_t removed; // luminance that clamping took, in CLAMP_UNITS to the clamp
	double estimated_relmse; // of the picture after error_sample samples; negative: unknown
	uint32_t error_sample;
	uint64_t error_us; // spent on it
	uint64_t upload_us, tree_us, compile_us, effects_us, trace_us, light_us, aov_us;
};

#define PT_TILES_PER_DISPATCH 4096u

uint64_t pt_job_bytes(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan);

// Make everything that the plan asks for. On failure nothing is left.
enum status pt_job_create(struct devices *devices, struct resident_scene *scene, const struct plan *plan,
			  struct technique_job **job, struct error *err);
void pt_job_destroy(struct technique_job *job);

// The pipeline that traces paths with these effects (bits 1 << candil_Effect), compiled, and its buffers for the first band.
// The pipeline is the device's, the set is the caller's to finish.
enum status pt_job_pipeline(struct technique_job *job, uint32_t effects, struct pipeline **pipeline, struct binding_set *set,
			    struct error *err);

// The pipeline of a shader with these effects and the job's ways of sampling. Not warm.
enum status pt_job_make_pipeline(struct technique_job *job, const struct shader *shader, uint32_t effects,
				 struct pipeline **pipeline, struct error *err);

// Buffers of a pipeline that traces, for a band; `result` is at BIND_ACCUMULATOR, which is BIND_AOV and BIND_FILM too.
enum status pt_job_bind(struct technique_job *job, struct pipeline *pipeline, const struct buffer *result,
			struct binding_set *set, struct error *err);

// Run a new pipeline once over nothing, so that the driver's compiler works now, under its own name in the account, and not
// in some slice.
enum status pt_job_warm_up(struct technique_job *job, struct pipeline *pipeline, const struct binding_set *set,
			   struct error *err);

// Begin the image again with dispatches of at most `segment` events for each of `batch` samples: what has been summed is
// forgotten.
enum status pt_job_restart(struct technique_job *job, uint32_t segment, uint32_t batch, struct error *err);

// Choose the size of the batch at the cursor.
void pt_job_next_batch(struct technique_job *job);

// The band that holds a tile.
struct pt_band *pt_job_band(const struct technique_job *job, uint32_t tile);

#endif
