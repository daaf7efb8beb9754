// Alias tables (Walker 1977, in Vose's form of 1991): an entry in constant time, with a probability in proportion to its
// weight.
#ifndef CANDIL_SCENE_ALIAS_H
#define CANDIL_SCENE_ALIAS_H

#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

// A draw takes a row, each as likely as the others, then that row's entry with the chance `keep`, else its alias.
struct alias_row {
	float keep; // 0…1
	uint32_t alias; // an entry
	float pmf; // of the entry as the table with its rounded `keep` draws it, not of the weight
};

// Fill `count` rows. Weights are finite and above zero. Scaling all weights by a power of two leaves every bit as it was.
// STATUS_MEMORY. *sum is the weights' sum. Any thread.
enum status alias_build(const double *weights, size_t count, struct alias_row *rows, double *sum, struct error *err);

#endif
