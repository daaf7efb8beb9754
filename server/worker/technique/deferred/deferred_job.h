// Internal to deferred.h: its job. deferred_setup.c makes and frees it, deferred_pass.c runs a piece of one pass, deferred.c
// moves the cursor over all of them. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_DEFERRED_JOB_H
#define CANDIL_WORKER_TECHNIQUE_DEFERRED_JOB_H

#include "server/worker/gl/scene.h"
#include "server/worker/plan/forecast.h"
#include "server/worker/technique/deferred/deferred.h"
#include "shaders/shared/scene_params.h"

// A range of rows, in pixels and in tiles.
struct deferred_rows {
	uint32_t first_row, rows; // pixels; first_row is a multiple of TILE_SIDE
	uint32_t first_tile, tiles; // of the image, row by row
};

// A band: rows whose sums fit one storage block. Most pictures are one band. Passes read neighbouring pixels, so they work
// on one more row of tiles on either side, as far as the picture goes; the sums of those rows are not used.
struct deferred_band {
	struct deferred_rows own, outer; // outer: with the rows on either side
	struct gl_buffer sums; // of the outer rows
	struct gl_buffer aov; // of the outer rows, only if asked for
};

// What a pass does: draw triangles, shade, add to the sums, make AOVs.
enum deferred_kind { DEFERRED_DRAW, DEFERRED_SHADE, DEFERRED_SUM, DEFERRED_AOV };

// A pass over a band, in units; a slice may end after any unit.
struct deferred_work {
	enum deferred_kind kind;
	const char *stage;
	struct gl_program *program; // held
	const struct deferred_pass *pass; // DEFERRED_SHADE
	struct forecast *forecast; // of its tiles; NULL: DEFERRED_DRAW
	double pixel_us; // DEFERRED_DRAW: of a pixel of a triangle's cost (deferred_cover.h); 0: not measured yet
};

#define DEFERRED_WORKS (DEFERRED_PASSES_MAX + 3)
_Static_assert(DEFERRED_WORKS + 1 <= PLAN_FORECASTS, "plan.h and deferred.h differ");

// The job.
struct deferred {
	struct gl_device *device;
	struct resident_scene *scene;
	struct gl_scene *gl_scene;
	uint32_t bindings; // of the scene that passes read
	struct plan plan;
	uint32_t rows; // that are worked on at once; 0: as many as the device binds
	struct deferred_pass passes[DEFERRED_PASSES_MAX];
	uint32_t pass_count;

	struct gl_buffer job; // struct scene_params
	struct gl_buffer counters; // struct pass_counters, growing, and the bits of pixels that met a surface
	struct gl_texture visibility, depth, radiance; // of a band
	unsigned framebuffer;
	struct deferred_band *bands;
	uint32_t band_count;

	// The passes of a sample: draw, the technique's, sum. Those of the AOVs: works[0], aov_work.
	struct deferred_work works[DEFERRED_WORKS];
	uint32_t work_count;
	struct deferred_work aov_work;
	struct forecast forecasts[PLAN_FORECASTS]; // where the plan has none

	// The cursor. Next is unit `unit` of pass `work` on band `band`: of the AOVs if they are not done, else of `sample`.
	bool aov_done;
	uint32_t sample, band, work, unit;

	struct pass_counters seen; // the counters when they were last read
	uint64_t rays, non_finite;
	struct gl_timer timer;
	uint64_t upload_us;
	uint64_t work_us; // on samples and AOVs
};

// How many units a pass has on a band: triangles for DEFERRED_DRAW, else tiles.
uint32_t deferred_units(const struct deferred *deferred, const struct deferred_work *work, uint32_t band);

// How many it has on the largest band.
uint32_t deferred_units_most(const struct deferred *deferred, const struct deferred_work *work);

// The pass at the cursor.
struct deferred_work *deferred_current(struct deferred *deferred);

// Issue `count` units of the pass at the cursor, from the cursor's unit on. Does not wait.
void deferred_record(struct deferred *deferred, uint32_t count);

// Make the driver compile a pass by running it over nothing, with the textures that it will have, unless its program has run
// with such before; *cold says whether. Blocks. Fails as gl_check does.
enum status deferred_warm_up(struct deferred *deferred, struct deferred_work *work, bool *cold, struct error *err);

#endif
