// Projections of form factors found by sampling onto what is known of all: that A_i F_ij = A_j F_ji, and that the sum of a
// row with what escaped and what was cut off is 1 (factors_check.h). A projection is a matrix of its own, made in slices;
// the one that it is made from stays as it is, and may get further rows meanwhile. On the host. Device's thread only.
//
// Pairs are averaged first and rows scaled behind that, which takes the rows' sums for certain and leaves pairs somewhat
// apart: averages alone have rows above 1, which add light at every bounce.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTORS_PROJECT_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTORS_PROJECT_H

#include <stdbool.h>

#include "server/worker/technique/radiosity/factors_host.h"

// What to do with the factors.
struct factors_wish {
	bool average; // replace A_i F_ij and A_j F_ji by their mean, the smaller element's counting for more in proportion
		      // of areas; a row gets the entries that only the other has
	bool close; // scale every row so that Σ F + escaped + cut = 1; one without entries stays as it is
};

// What it is made of.
enum factors_projection_stage { PROJECTION_COUNT, PROJECTION_TURN, PROJECTION_ROWS, PROJECTION_DONE };

// A projection under way.
struct factors_projection {
	const struct factors *from;
	const float *area;
	struct factors_wish wish;
	struct factors_host host;
	enum factors_projection_stage stage;
	uint32_t row; // the next
	// By columns, where pairs are averaged: column j has the entries first[j] … first[j + 1] - 1, their rows ascending.
	uint64_t *first;
	uint32_t *rows;
	float *values;
	// A row under way.
	uint32_t *columns;
	float *merged;
	struct factors to;
};

// Begin. `area`: of each element, m². `which`: 1 for the elements whose rows are taken, as far as they were put; NULL: all.
// All three must outlive the projection, and these rows must stay as they are. STATUS_MEMORY.
enum status factors_projection_init(struct factors_projection *projection, const struct factors *from, const float *area,
				    const uint8_t *which, const struct factors_wish *wish, struct error *err);

// Work for about budget_us. STATUS_MEMORY: it may be called again once there is room. STATUS_DEVICE.
enum status factors_projection_step(struct factors_projection *projection, uint32_t budget_us, struct error *err);
bool factors_projection_finished(const struct factors_projection *projection);

// Hand over the matrix that was made, once it is finished. The caller finishes it.
void factors_projection_take(struct factors_projection *projection, struct factors *to);

// Free it. Zeroed is fine.
void factors_projection_finish(struct factors_projection *projection);

#endif
