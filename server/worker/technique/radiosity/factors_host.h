// Rows of a matrix of form factors in host memory, to be read in any order. Where the device's memory is the host's they are
// that memory, else a copy, made in slices. These rows must stay as they are; others may come, go and move. Device's thread
// only.
//
//   factors_host_init, factors_host_step until factors_host_finished, factors_host_row …, factors_host_finish
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTORS_HOST_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTORS_HOST_H

#include "server/worker/technique/radiosity/factors_window.h"

// The rows.
struct factors_host {
	const struct factors *factors;
	const uint8_t *which; // by row; NULL: all
	uint32_t next; // row to be copied
	// A copy.
	uint64_t *first; // by row: its first entry; NULL: rows are read in place
	uint32_t *columns;
	float *values;
	uint64_t count; // entries so far
	struct factors_window window;
};

// Begin. `which`: 1 for the rows that are wanted, as far as they were put; NULL: all. It must outlive the rows.
// STATUS_MEMORY: nothing is left.
enum status factors_host_init(struct factors_host *host, const struct factors *factors, const uint8_t *which,
			      struct error *err);

// Free it. Zeroed is fine.
void factors_host_finish(struct factors_host *host);

// Copy rows for about budget_us. STATUS_MEMORY, STATUS_DEVICE: it may be called again.
enum status factors_host_step(struct factors_host *host, uint32_t budget_us, struct error *err);
bool factors_host_finished(const struct factors_host *host);

// A row, once it is finished.
struct row_view factors_host_row(const struct factors_host *host, uint32_t i);

#endif
