// A value at the border of a smooth surface from values within it: what is known on one side only is extrapolated there by a
// linear function, fitted to what is near (least squares, weights by the inverse square of the distance). The less of what
// is near the function explains, by the adjusted coefficient of determination R², the less of the way from the mean to it is
// gone: noise, the edge of a shadow and the peak beneath a lamp tell no slope. Host only, any thread.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_CORNER_FIT_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_CORNER_FIT_H

#include <stdint.h>

// What is near: fewer than the least tell no slope in two directions.
#define CORNER_FIT_LEAST 4u
#define CORNER_FIT_MOST 48u

// A patch's middle, and the irradiance there, three channels.
struct corner_sample {
	const float *at; // metres
	const float *light;
};

// Move values at a place, W/m², from a mean to what the fit says. They go beyond the samples' own range by CORNER_FIT_BEYOND
// of it at most, or of the least sample where that is less: nothing becomes negative, and what is bright beside the dark no
// brighter. Samples in one line tell no slope across it. What they give all alike stays to the bit.
void corner_fit(const float place[3], const struct corner_sample *samples, uint32_t count, float values[3]);

// A linear function leaves the range of what is in the middles of a grid of quads by half of it in the grid's corners, and
// of triangles by two thirds.
#define CORNER_FIT_BEYOND 0.75

#endif
