// Internal to factor_build.h: where nodes have moved, rows of factors that cannot have changed are taken over from those of
// the scene as loaded. A row stays if its element has not moved, saw nothing of what has, and sees none of it now: all boxes
// around moved patches are behind it. Other rows are made again. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTOR_MOVES_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTOR_MOVES_H

#include "server/worker/technique/radiosity/factor_build.h"

// What has moved.
struct factor_moves {
	const struct factor_build *from; // the factors of the scene as loaded, which the holder keeps
	uint8_t *moved; // by patch
	double (*boxes)[2][3]; // around the patches of each node that has moved, at their new places
	uint32_t box_count;
	uint32_t next; // row
	struct factors_window window; // of `from`
};

// Begin to take rows over from `from` into `build`, whose scene has the edits. False: nothing can be taken over, since the
// elements are others, or light goes round by mirrors; or there is no memory. *moves is the caller's.
bool factor_moves_init(struct factor_moves *moves, const struct factor_build *from, const struct factor_build *build,
		       const struct resident_scene *scene);
void factor_moves_finish(struct factor_moves *moves);

// Take over rows for about budget_us. *done: no row is left. Fails as factors_window_row and factors_take.
enum status factor_moves_step(struct factor_moves *moves, struct factor_build *build, uint32_t budget_us, bool *done,
			      struct error *err);

#endif
