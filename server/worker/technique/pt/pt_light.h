// The path tracer's light paths (shaders/pt/light.comp.glsl): a second pass over the same tiles and samples, which exists if
// the plan has EFFECT_CAUSTICS. For each sample a band has one light path for every few pixels. They contribute to the
// band's own pixels, in its film, which is apart from the sums of the camera paths. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_LIGHT_H
#define CANDIL_WORKER_TECHNIQUE_PT_LIGHT_H

#include "server/worker/technique/pt/pt_job.h"

// Device memory of the pass, in bytes; 0 without the effect.
uint64_t pt_light_bytes(const struct blob_view *scene, const struct plan *plan);

// Make the pass's buffers, and fill in what its shader reads of `params`. The job's bands are set before. Does nothing
// without the effect. STATUS_MEMORY, STATUS_DEVICE; pt_light_finish frees what was made by then.
enum status pt_light_init(struct technique_job *job, struct scene_params *params, struct error *err);

// Make the pass's pipeline and bindings, or make them again. *compiles becomes true if the driver had to compile. Does
// nothing without the effect. Fails as pt_light_init.
enum status pt_light_make_pass(struct technique_job *job, bool *compiles, struct error *err);

// Free the pass, whatever part of it was made.
void pt_light_finish(struct technique_job *job);

// The pass's compiled pipeline with other effects, and its bindings for the first band. The caller finishes the set.
enum status pt_light_pipeline(struct technique_job *job, uint32_t effects, struct pipeline **pipeline,
			      struct binding_set *set, struct error *err);

// The number of tiles of light paths that go with the first `tiles` tiles of a band. There are fewer light paths than
// pixels.
static inline uint32_t pt_light_tiles(uint32_t tiles)
{
	return (tiles + TILES_PER_LIGHT_TILE - 1) / TILES_PER_LIGHT_TILE;
}

// Record the light paths of some of a band's tiles for the batch at the job's cursor.
void pt_light_record(const struct technique_job *job, const struct pipeline *pipeline, const struct binding_set *set,
		     const struct pt_band *band, uint32_t first_tile, uint32_t tiles);

// The radiance of one unit of a band's film in half A and B, given the samples that are done, W/(m² sr); 0 for a half
// without samples.
void pt_light_units(const struct technique_job *job, const struct pt_band *band, double units[2]);

// Read a band's film, struct film_pixel for each pixel. The caller frees *film; NULL without the effect. Blocks.
// STATUS_MEMORY, STATUS_DEVICE; free *film on failure, too.
enum status pt_light_read(const struct technique_job *job, const struct pt_band *band, uint32_t **film, struct error *err);

#endif
