#include "server/worker/technique/pt/pt_relmse.h"

#include <math.h>
#include <stdbool.h>

#define NORMAL_90 1.645 // standard deviations on either side that hold nine of ten
#define SYSTEMATIC 0.15 // of the sum: standard deviation of what all pixels share, measured by tests/bench/bench_error.py
#define LUCKY_MOST 0.5
#define ALIKE 3.0 // times: what makes one outlier a small bright thing and no luck makes others so, too

struct estimate relmse_estimate(const struct relmse_sums *s, uint64_t pixels)
{
	if (!(s->light > 0))
		return ESTIMATE_UNKNOWN;
	const double count = 3 * (double)pixels, shared = SYSTEMATIC * s->terms;
	const double noise = s->noise + shared * shared;
	const double below = NORMAL_90 * sqrt(noise + ALIKE * s->below), above = NORMAL_90 * sqrt(noise + s->above);
	const bool found = s->lucky <= LUCKY_MOST * s->light;
	return (struct estimate){
	    .relmse = s->terms / count,
	    .low = s->terms > 0 ? s->terms * (s->terms / (s->terms + below)) / count : 0,
	    .high = found ? (s->terms + above) / count : -1,
	    .kind = candil_ErrorKind_ERROR_KIND_MEASURED,
	};
}
