// FLIP: how much a person sees of the difference of two pictures that alternate in one place. 0: nothing; 1: as between
// green and blue, the most that a display can. One thread for each pair of pictures; same pictures, same bits.
//
// Sources: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: A Difference Evaluator for Alternating
// Images", HPG 2020, for pictures as a display shows them; Andersson, Nilsson, Shirley, Akenine-Möller, "Visualizing Errors
// in Rendered High Dynamic Range Images", Eurographics Short Papers 2021, for radiance. The observer sees
// FLIP_PIXELS_A_DEGREE.
#ifndef CANDIL_COMPARE_FLIP_H
#define CANDIL_COMPARE_FLIP_H

#include <stdbool.h>
#include <stdint.h>

#include "server/compare/picture.h"

// At 0.7 m from a display that is 3,840 pixels and 0.7 m wide, as both papers have it.
#define FLIP_PIXELS_A_DEGREE 67.02064327658226

// The most exposures for one pair of pictures. The papers have no bound: a sun beside a night takes more.
#define FLIP_EXPOSURES_MOST 64u

struct flip {
	double mean; // over the pixels that count
	double max;
	// A pixel's value is the largest of those at `exposures` steps from exposure_low to exposure_high, factors as powers
	// of
	// 2. Pictures as a display shows them: 0, 0, 1.
	double exposure_low, exposure_high;
	uint32_t exposures;
};

// Compare `a` with the reference `b`, both of equal size and finite. Pixels whose `excluded` is below 0 do not count, as
// metrics_compare marks them; metrics_blank must have blanked them. `high_range`: the pictures are radiance, which is
// compared at each of the exposures that the reference calls for; otherwise they are what a display shows, 0…1. The
// exposures reach from that in which the reference's brightest pixel is at 0.85 of the display's range by the ACES curve to
// that in which its median is. Where more than half of a reference is black, the median is of the rest. The caller's `map`,
// unless it is NULL, receives the value of each pixel (width × height), or what `excluded` has below 0.
// STATUS_MEMORY; no other failure.
enum status flip_compare(const struct picture *a, const struct picture *b, const float *excluded, bool high_range,
			 struct flip *flip, float *map, struct error *err);

#endif
