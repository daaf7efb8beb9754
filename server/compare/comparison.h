// Everything that is measured of a picture beside a reference: the figures, and what each pixel has of them. One thread for
// each pair of pictures.
#ifndef CANDIL_COMPARE_COMPARISON_H
#define CANDIL_COMPARE_COMPARISON_H

#include <stdbool.h>

#include "server/compare/flip.h"
#include "server/compare/metrics.h"

struct comparison {
	struct metrics metrics;
	struct flip flip;
	bool high_range; // flip is of radiance at several exposures
};

// Compare `a` with the reference `b`, of equal size; both stay as they are. Pixels of `b` above `mask_above` in a channel
// are left out, as metrics_compare does it, which fills `error`; `flip_map` is flip_compare's, or NULL. Two pictures as a
// display shows them are compared as such, any others as radiance. Failures are those of metrics_compare and flip_compare.
enum status comparison_make(const struct picture *a, const struct picture *b, double mask_above,
			    struct comparison *comparison, float *error, float *flip_map, struct error *err);

#endif
