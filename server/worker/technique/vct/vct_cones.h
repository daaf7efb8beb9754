// Sets of cones that share out the cosine-weighted hemisphere.
#ifndef CANDIL_WORKER_TECHNIQUE_VCT_CONES_H
#define CANDIL_WORKER_TECHNIQUE_VCT_CONES_H

#include <stdint.h>

#include "shaders/shared/vct.h"

// As many cones as a set has that is at least `wanted`, or the largest: 6, 9, 16 or 32.
uint32_t vct_cones_count(uint32_t wanted);

// Directions in a frame whose z is the normal with their weights (they sum to 1), and tangents of the half apertures.
//
// Six: one about the normal with 1/4 and five at 60° with 3/20 each, 60° wide (Crassin et al. 2011, "Interactive indirect
// illumination using voxel cone tracing"; weights: Villegas and Ramírez 2016). The others: rings of the unit disc in
// equal areas, which under the cosine are equal shares (Nusselt); each cone is as wide as its share's solid angle.
void vct_cones_fill(uint32_t count, float cone[VCT_CONES_MAX][4], float tangent[VCT_CONES_MAX][4]);

#endif
