// Sets of cones that cover the cosine-weighted hemisphere. Host only, any thread; nothing fails.
#ifndef CANDIL_WORKER_TECHNIQUE_VCT_CONES_H
#define CANDIL_WORKER_TECHNIQUE_VCT_CONES_H

#include <stdint.h>

#include "shaders/shared/vct.h"

// The size of the smallest set of at least `wanted` cones, or of the largest set: 6, 9, 16 or 32.
uint32_t vct_cones_count(uint32_t wanted);

// Fill in a set of `count` cones: cone[i] is a direction in the frame whose z is the normal, and a weight; the weights sum
// to 1. tangent[i][0] is the tangent of the half aperture.
//
// Six: one about the normal with weight 1/4, and five at 60° with 3/20 each, all 60° wide (Crassin et al. 2011, "Interactive
// indirect illumination using voxel cone tracing"; weights: Villegas and Ramírez 2016). The other sets divide the unit disc
// into rings and these into equal areas, which under the cosine are equal shares (Nusselt's analogue). The solid angle of
// each cone is that of its share.
void vct_cones_fill(uint32_t count, float cone[VCT_CONES_MAX][4], float tangent[VCT_CONES_MAX][4]);

#endif
