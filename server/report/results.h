// results.json and results.csv: the figures of a study for other programs. One thread.
#ifndef CANDIL_REPORT_RESULTS_H
#define CANDIL_REPORT_RESULTS_H

#include <math.h>

#include "server/report/judge.h"

// The object that results.json has, to be released by json_decref; NULL: no memory. A figure that is unknown is null.
json_t *results_json(const struct figures *figures, const struct judgement *judgement);

// One row a point, after a row of names; RFC 4180. To be freed; NULL: no memory.
char *results_csv(const struct figures *figures);

// What each reply and each quote said of a run, and what came out; and how often that held. Keys are "runs", "summary" and
// "not_resolved": how many errors were predicted of points that are not resolved, and do not count.
json_t *predictions_json(const struct figures *figures);

// What each effect of the scene costs and what its absence does: an array. `figures` has the points with it switched off.
json_t *ablation_json(const struct figures *figures);

// A number, null unless it is finite.
static inline json_t *results_number(double value)
{
	return isfinite(value) ? json_real(value) : json_null();
}

#endif
