// The estimated relMSE of a picture and its interval, from what each pixel's two independent halves of samples say.
//
// With a and b the means of the halves, d = (a − b) / 2 has mean 0 and the variance of the picture's own value x = (a + b)
// / 2. So a pixel's term is t = d² / (ρ² + 0.01) over its channels, where ρ stands for the true value r. Where |a − b| ≤ x /
// 2, ρ is x. Elsewhere x would hide its own error: a firefly F times as bright as r is wrong by (F / r)², and counts as 1 by
// its own mean. There ρ is the mean of the other pixels of its tile, without itself (Quenouille, Notes on bias in
// estimation, Biometrika 43, 1956) and trimmed of the brightest (Tukey, A survey of sampling from contaminated
// distributions, 1960), unless neighbours or both halves tell that it is bright indeed. shaders/pt/error.comp.glsl has the
// cases, and for each how far ρ may be off, which gives each term a lower and a higher end.
//
// The interval. Of normal noise d and the true error e are independent and alike, so with v their variance
// Var(d² − e²) = 4 v², and E[d⁴] = 3 v²: 4/3 t² estimates the variance of a term beside the true one. Of an outlier d and e
// are the same number, and |x − ρ| shows e: then (t − (x − ρ)² / (ρ² + 0.01))² is the lesser, times 1.5 since it is one of
// its kind. To these are added the squares of what the ends differ by, pixels being independent, and the square of what they
// share. The low end divides, since the sum is skewed and above 0.
//
// No upper end. What has not been seen has as much weight as what has been seen once (Good, The population frequencies of
// species and the estimation of population parameters, Biometrika 40, 1953, equation 2 with r = 0). Light that came to one
// half of one pixel alone, above its surroundings, has been seen once. If that is more than half of the picture's light, as
// much may be missing, and nothing bounds the error. If no light was found at all, nothing is known of it.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_RELMSE_H
#define CANDIL_WORKER_TECHNIQUE_PT_RELMSE_H

#include <stdint.h>

#include "server/base/estimate.h"

// Sums over pixels. They are added up in an order that does not change from run to run.
struct relmse_sums {
	double terms; // t
	double noise; // variance of t beside the true term
	double below, above; // (t − its lower end)², (t − its higher end)²
	double lucky; // radiance over pixels and channels that came to one half alone, above the surroundings
	double light; // all radiance
};

// The estimate over a picture of so many pixels (> 0).
struct estimate relmse_estimate(const struct relmse_sums *sums, uint64_t pixels);

// The estimate of a picture that nobody expects to be other than it is: no error, and none above.
#define RELMSE_NONE ((struct estimate){.kind = candil_ErrorKind_ERROR_KIND_MEASURED})

#endif
