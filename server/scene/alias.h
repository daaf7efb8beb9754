// Alias tables (Walker 1977, in Vose's form of 1991): they choose an entry in constant time, with a probability
// proportional to its weight.
#ifndef CANDIL_SCENE_ALIAS_H
#define CANDIL_SCENE_ALIAS_H

#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

// A draw picks a row uniformly, then takes that row's entry with probability `keep`, otherwise its alias.
struct alias_row {
	float keep; // 0…1
	uint32_t alias; // index of an entry
	float pmf; // probability of the entry in the table with its rounded `keep`, not in the weights
};

// Fill `count` rows owned by the caller. Weights must be finite and above zero. Scaling all weights by a power of two does
// not change any bit of the rows. *sum becomes the sum of the weights. STATUS_MEMORY. Any thread.
enum status alias_build(const double *weights, size_t count, struct alias_row *rows, double *sum, struct error *err);

#endif
