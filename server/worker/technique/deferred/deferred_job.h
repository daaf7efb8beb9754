// Inside deferred.h: its job. deferred_setup.c makes and frees it, deferred_pass.c runs a piece of one pass, deferred.c the
// cursor over all of them.
#ifndef CANDIL_WORKER_TECHNIQUE_DEFERRED_JOB_H
#define CANDIL_WORKER_TECHNIQUE_DEFERRED_JOB_H

#include "server/worker/gl/scene.h"
#include "server/worker/technique/deferred/deferred.h"
#include "shaders/shared/scene_params.h"

// Rows of tiles, or of pixels.
struct deferred_rows {
	uint32_t first_row, rows; // pixels; first_row is a multiple of TILE_SIDE
	uint32_t first_tile, tiles;
};

// Rows whose sums fit one storage block. Most pictures are one band. Passes look at pixels near by: they work on a row of
// tiles more on either side, as far as the picture goes, of which no sum is taken.
struct deferred_band {
	struct deferred_rows own, outer;
	struct gl_buffer sums; // of the outer rows
	struct gl_buffer aov; // likewise, only if asked for
};

enum deferred_kind { DEFERRED_DRAW, DEFERRED_SHADE, DEFERRED_SUM, DEFERRED_AOV };

// A pass over a band, in units that a slice can end between.
struct deferred_work {
	enum deferred_kind kind;
	const char *stage;
	struct gl_program *program; // held
	const struct deferred_pass *pass; // DEFERRED_SHADE
	double unit_us; // measured, of a tile, or of a triangle's cost (deferred_cover.h); 0: not yet
};

#define DEFERRED_WORKS (DEFERRED_PASSES_MAX + 3)

struct deferred {
	struct gl_device *device;
	struct resident_scene *scene;
	struct gl_scene *gl_scene;
	struct plan plan;
	uint32_t rows; // that are worked on at once; 0: as many as the device binds
	struct deferred_pass passes[DEFERRED_PASSES_MAX];
	uint32_t pass_count;

	struct gl_buffer job; // struct scene_params
	struct gl_buffer counters; // struct pass_counters, growing
	struct gl_texture visibility, depth, radiance; // of a band
	unsigned framebuffer;
	struct deferred_band *bands;
	uint32_t band_count;

	// works[0]: draw; the technique's; sum. aov_works: draw, AOV.
	struct deferred_work works[DEFERRED_WORKS];
	uint32_t work_count;
	struct deferred_work aov_work;

	// The cursor: next is unit `unit` of work `work` on band `band`, of the AOVs if they are not done, else of `sample`.
	bool aov_done;
	uint32_t sample, band, work, unit;

	struct pass_counters seen;
	uint64_t rays, non_finite;
	struct gl_timer timer;
	uint64_t upload_us;
};

// Triangles, or tiles of the cursor's band.
uint32_t deferred_units(const struct deferred *deferred, const struct deferred_work *work);

// The cursor's work.
struct deferred_work *deferred_current(struct deferred *deferred);

// Record `count` units of the cursor's work, from the cursor's unit on.
void deferred_record(struct deferred *deferred, uint32_t count);

// Compile: a piece of nothing. The program is then marked as warm.
enum status deferred_warm_up(struct deferred *deferred, struct deferred_work *work, struct error *err);

#endif
