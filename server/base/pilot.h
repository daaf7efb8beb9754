// What a pilot tells of one technique on one scene: a small picture of the same view, its time and its error. A value; any
// thread.
#ifndef CANDIL_BASE_PILOT_H
#define CANDIL_BASE_PILOT_H

#include <stdint.h>

#include "server/base/estimate.h"
#include "server/base/work.h"

struct pilot_result {
	uint32_t pixels; // 0: this technique was not looked at, or could not render it
	uint32_t samples; // that each pixel had
	uint32_t refused; // not 0: it could not render it, for another reason than want of time or memory
	uint32_t slowed; // not 0: what compiled had these times, too, so they are no rate
	double cold_us; // compiling
	double setup_us; // what is made once for a scene: uploads, trees, voxels; without what `work` has
	double pixel_us; // of all pixels together, whatever the samples, with what no stage has
	double sample_us; // of all samples of all pixels together
	struct estimate error; // of a technique with noise, the relMSE at so many samples
	// Of another, its bias: the relMSE of smaller pictures beside those of the reference, which `path` samples made, of
	// one sample and of more, by which edges are smoothed. `edges` is the share of it, 0 … 1, that more samples mend: it
	// lies at edges, which are fewer of a larger picture's pixels.
	struct pilot_bias {
		uint32_t pixels, samples; // 0: none
		double edges;
		struct estimate error;
	} bias[2];
	struct work work; // what is left to be made once for the scene, and what some of it took
};

#endif
