// The path tracer's light paths (shaders/pt/light.comp.glsl): a second pass over the same tiles and samples, there if the
// plan has EFFECT_CAUSTICS. A band has a light path a sample for every few pixels; they reach the band's own pixels
// and leave what they bring in its film, apart from the sums of the camera's paths.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_LIGHT_H
#define CANDIL_WORKER_TECHNIQUE_PT_LIGHT_H

#include "server/worker/technique/pt/pt_job.h"

// Device memory that the pass takes; 0 without the effect.
uint64_t pt_light_bytes(const struct blob_view *scene, const struct plan *plan);

// Make its buffers, and fill in what its shader reads of `params`. Without the effect, nothing. The job's bands are cut.
enum status pt_light_init(struct technique_job *job, struct scene_params *params, struct error *err);

// Make its pipeline and bindings, again if they are there; *compiles becomes true if the driver had to compile. Without the
// effect, nothing.
enum status pt_light_make_pass(struct technique_job *job, bool *compiles, struct error *err);
void pt_light_finish(struct technique_job *job);

// The pipeline with other effects, compiled, and its buffers for the first band. The set is the caller's to finish.
enum status pt_light_pipeline(struct technique_job *job, uint32_t effects, struct pipeline **pipeline,
			      struct binding_set *set, struct error *err);

// Light paths are fewer than pixels' samples: the tiles of light paths that go with a band's first so many tiles.
static inline uint32_t pt_light_tiles(uint32_t tiles)
{
	return (tiles + TILES_PER_LIGHT_TILE - 1) / TILES_PER_LIGHT_TILE;
}

// Record the light paths of some of a band's tiles for the batch at the job's cursor.
void pt_light_record(const struct technique_job *job, const struct pipeline *pipeline, const struct binding_set *set,
		     const struct pt_band *band, uint32_t first_tile, uint32_t tiles);

// What one of a film's whole numbers is in half A and B after the samples that are done, W/(m² sr); 0 without one.
void pt_light_units(const struct technique_job *job, const struct pt_band *band, double units[2]);

// A band's film, struct film_pixel a pixel, to be freed; NULL without the effect.
enum status pt_light_read(const struct technique_job *job, const struct pt_band *band, uint32_t **film, struct error *err);

#endif
