// How the matrix of form factors keeps its blocks: for factors*.c.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTORS_BLOCKS_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTORS_BLOCKS_H

#include "server/worker/technique/radiosity/factors.h"

// Entries that a row of `count` takes of its block.
static inline uint32_t factors_padded(uint32_t count)
{
	return (count + FACTORS_ALIGN - 1) / FACTORS_ALIGN * FACTORS_ALIGN;
}

// Where a row is to go.
struct factors_place {
	uint32_t block, first;
};

// What the blocks were before room was found.
struct factors_mark {
	uint32_t block_count, entries; // of the last block
};

// Find room for rows of counts[0 … n - 1] entries, one after the other, and make the blocks that lack; their entries are 0.
// The blocks' `entries` then count these rows; *before is what factors_undo needs. STATUS_MEMORY, STATUS_DEVICE: nothing has
// changed.
enum status factors_find(struct factors *factors, const uint32_t *counts, uint32_t n, struct factors_place *places,
			 struct factors_mark *before, struct error *err);

// Take back what factors_find found, before any row was put there.
void factors_undo(struct factors *factors, const struct factors_mark *before);

// Compact the matrix if so much of it is holes that it pays and there is room for it.
void factors_tidy(struct factors *factors);

#endif
