// Alias tables (Walker 1977, in Vose's form of 1991): an entry in constant time, with a probability in proportion to its
// weight.
#ifndef CANDIL_SCENE_ALIAS_H
#define CANDIL_SCENE_ALIAS_H

#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

struct alias_row {
	float keep;
	uint32_t alias;
	float pmf; // of the entry as the table with its rounded `keep` draws it, not of the weight
};

// Fill `count` rows. Weights are finite and above zero. Scaling all weights by a power of two leaves every bit as it was.
// STATUS_MEMORY. *sum is the weights' sum.
enum status alias_build(const double *weights, size_t count, struct alias_row *rows, double *sum, struct error *err);

#endif
