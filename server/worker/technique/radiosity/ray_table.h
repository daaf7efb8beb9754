// The rays of an element of radiosity, as numbers: which place on it, and which direction. One table serves all elements
// (shaders/radiosity/factor_source.glsl). Neighbours in it have neighbouring directions, so that they are traced together:
// it is sorted by Hilbert's curve over the square that the directions' disc is mapped from. Host only, any thread.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_RAY_TABLE_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_RAY_TABLE_H

#include <stdint.h>

#include "server/base/error.h"

#define RAY_TABLE_MOST 4000000u // rays

// A ray.
struct table_ray {
	uint32_t word[4];
};

// The first `count` points of Sobol' in four dimensions, with the direction numbers of Joe and Kuo 2008 ("Constructing
// Sobol sequences with better two-dimensional projections"), as fractions of 2³²: words 0 and 1 choose the direction, 2 and
// 3 the place. `count` is 1 … RAY_TABLE_MOST. The caller frees *rays. STATUS_MEMORY.
enum status ray_table_sobol(uint32_t count, struct table_ray **rays, struct error *err);

// `count` cells of equal area on the unit disc, and so of one form factor, in rings, about as wide as they are long (Beckers
// and Beckers 2012, "A general rule for disk and hemisphere partition into equal-area cells"). Words 0 and 1 are their
// middles' x and y as floats: in half of the cell's area and of its angle. Words 2 and 3 are 0.
enum status ray_table_cells(uint32_t count, struct table_ray **rays, struct error *err);

#endif
