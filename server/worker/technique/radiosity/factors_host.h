// The entries of a matrix of form factors in host memory. Where the device's memory is the host's they are that memory, else
// a copy. They are good as long as no row comes, goes or moves (factors->changes). Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTORS_HOST_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTORS_HOST_H

#include <stdbool.h>

#include "server/worker/technique/radiosity/factors.h"

// A block of the matrix.
struct host_block {
	uint32_t *columns;
	float *values;
	bool owned; // else they are the device's memory, which is the host's
};

// A row for reading.
struct row_view {
	const uint32_t *columns;
	float *values;
	uint32_t count;
	bool there;
};

// All blocks; the caller frees them with host_free. STATUS_MEMORY, STATUS_DEVICE: *blocks is NULL.
enum status host_read_all(const struct factors *factors, struct host_block **blocks, struct error *err);

// The blocks of a matrix that may change between two slices of work on it.
struct factors_host {
	struct host_block *blocks; // NULL: not read
	uint32_t block_count;
	uint64_t changes; // of the matrix when they were read
};

// Read them, unless they are good. *anew: whether that was necessary. STATUS_MEMORY, STATUS_DEVICE: there are none.
enum status factors_host_refresh(struct factors_host *host, const struct factors *factors, bool *anew, struct error *err);

// Free them. Zeroed is fine.
void factors_host_finish(struct factors_host *host);

// `count`: of the matrix's blocks when they were read. NULL is allowed.
void host_free(struct host_block *blocks, uint32_t count);

// The row i.
struct row_view host_row(const struct factors *factors, const struct host_block *blocks, uint32_t i);

// The sum of its entries.
double host_sum(const struct row_view *row);

#endif
