// The estimated relMSE of a picture and its interval, from what each pixel's two independent halves of samples say.
//
// With a and b the means of the halves, d = (a − b) / 2 has mean 0 and the variance of the picture's own value x = (a + b) / 2:
// the random halves of McCarthy (Pseudoreplication: half-samples, Review of the International Statistical Institute 37, 1969,
// section 3) with one pair a stratum. So a pixel's term is t = d² / (ρ² + 0.01) over its channels, where ρ stands for the true
// value r. Where |a − b| < x / 2, ρ is x. Elsewhere x would hide its own error: a firefly F times as bright as r is wrong by
// (F / r)², and counts as 1 by its own mean. There ρ is the mean of the other pixels of its tile of 8 × 8, without itself
// (Quenouille's jackknife, Biometrika 43, 1956, section 2), unless neighbours or both halves tell that it is bright indeed;
// shaders/pt/error.comp.glsl has the cases, and for each how far ρ may be off. For it each term has a lower and a higher end.
//
// The interval. Of normal noise d and the true error are independent and alike, so with v a pixel's variance Var(d² − e²) = 4 v²
// and E[d⁴] = 3 v²: 4/3 Σ t² estimates the variance of Σ t beside the true sum. For one outlier it is an upper bound, because
// there d and e are the same number. To it Σ (t − end)² is added, pixels being independent, and SYSTEMATIC for what all
// pixels share. The low end divides, since t is skewed and the sum above 0.
//
// No upper end. Good (The population frequencies of species and the estimation of population parameters, Biometrika 40,
// 1953, section 2) shows that what has not been seen has as much weight as what has been seen once. Light that came to one half
// of one pixel alone, above that pixel's surroundings, has been seen once. If that is more than half of the picture's light, as
// much may be missing, and nothing bounds the error. So too if no light was found at all.
#ifndef CANDIL_WORKER_TECHNIQUE_RELMSE_H
#define CANDIL_WORKER_TECHNIQUE_RELMSE_H

#include <stdint.h>

#include "server/base/estimate.h"

// Sums over pixels. A technique adds them up, in an order that does not change from run to run.
struct relmse_sums {
	double terms; // t
	double squares; // t²
	double below, above; // (t − its lower end)², (t − its higher end)²
	double lucky; // radiance over pixels and channels that came to one half alone, above the surroundings
	double light; // all radiance
};

// The estimate over a picture of so many pixels (> 0).
struct estimate relmse_estimate(const struct relmse_sums *sums, uint64_t pixels);

// The estimate of a picture that nobody expects to be other than it is: no error, and none above.
#define RELMSE_NONE ((struct estimate){0})

#endif
