// Rows of a matrix of form factors for the host to read, one after another. Where the device's memory is the host's they are
// read in place; else a part of a block is copied at a time: as much as a slice has time for, the more the longer rows are
// asked for that follow each other. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTORS_WINDOW_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTORS_WINDOW_H

#include <stdbool.h>

#include "server/worker/technique/radiosity/factors.h"

#define FACTORS_WINDOW_ENTRIES (1u << 20) // that are copied at once, but for a row that is longer

// A row. Good until the matrix changes, and of a window until it is asked for another row.
struct row_view {
	const uint32_t *columns;
	const float *values;
	uint32_t count;
	bool there; // it was put
};

// The part that was copied last. Zeroed: none.
struct factors_window {
	bool columns_only; // the values of rows are NULL
	uint32_t *columns;
	float *values;
	uint32_t room; // entries that the arrays have room for
	uint32_t block, first, count; // the entries that they hold
	uint64_t changes; // of the matrix when they were copied
};

// The row i. STATUS_MEMORY, STATUS_DEVICE: the window is empty.
enum status factors_window_row(struct factors_window *window, const struct factors *factors, uint32_t i,
			       struct row_view *row, struct error *err);

// Free it.
void factors_window_finish(struct factors_window *window);

// The sum of a row's entries.
double row_view_sum(const struct row_view *row);

#endif
