// The figures of a study: what its images are worth beside the reference of their view, run by run and point by point. A
// point is the runs of one view, technique, set of settings and effects, over their seeds. One thread; an image is in memory
// only while it is measured, the references all the time.
//
// A reference has noise of its own, and the relMSE of a picture beside it is too high by the reference's own relMSE: with x
// and r independent and E r = t, E (x − r)² = E (x − t)² + E (r − t)². So that is taken off wherever it is known, and what
// is left is never below 0. Where it is less than the reference's own the point is not resolved: the reference is too noisy
// to tell its error. RMSE and FLIP stay as they are measured, and so does the signed mean, which noise does not move.
//
// Whether a point has noise is seen from its pictures: those of two seeds differ, or they do not. A technique whose error
// hardly falls with the samples still differs from seed to seed if the seed moves where in a pixel it looks.
#ifndef CANDIL_REPORT_FIGURES_H
#define CANDIL_REPORT_FIGURES_H

#include <math.h>

#include "server/compare/picture.h"
#include "server/report/statistics.h"
#include "server/report/study.h"

// Sides of a tile, of which a bias is told by itself: so many tiles at most across or down, none smaller than so many
// pixels.
#define TILES_MOST 48u
#define TILE_LEAST 8u

#define BIAS_ALPHA 0.05

#define RUNS_OF_POINT 1024u // further ones are points of their own

// Of a point: is its difference from the reference noise or bias? By Welch's test on the mean luminance of every tile over
// the seeds (Jung, Hanika, Dachsbacher, "Detecting Bias in Monte Carlo Renderers using Welch's t-test", Journal of Computer
// Graphics Techniques 9(2), 2020). The second sample is the reference: its mean is the reference image's, its variance that
// of the point with the reference's own technique and settings but fewer samples, over that one's seeds, times the ratio of
// the samples: variance falls as 1/N. For that point itself both have one variance, of n - 1 degrees. Of the tiles told from
// noise at most BIAS_ALPHA are by chance.
struct bias {
	uint32_t tiles; // 0: there was nothing to tell it from noise by
	double share; // of the tiles that are biased
	double by_chance; // of the tiles with p below BIAS_ALPHA, uncorrected: about BIAS_ALPHA if there is no bias
	float *difference; // of each tile, relative to the reference's mean there + 0.1; owned
	bool *biased; // owned
};

struct point {
	struct study_run *runs; // `count` of them, which belong to the study
	size_t count;
	const struct study_run *shown; // whose image is shown and whose FLIP it is: the first with an image; NULL: none.
				       // FLIP is of kind "point" alone, and the images of kind "cold" are not read
	bool noise; // its seeds' pictures differ
	size_t seeds; // with an image, each counted once
	double relmse, relmse_measured; // mean over seeds, corrected and not
	struct interval
	    relmse_interval; // of the corrected mean, by its seeds and the reference's own interval, both of 95 %
	struct interval seeds_interval; // by its seeds alone: for points that have the same reference
	double relmse_noise; // how much of relmse is noise, which the mean of the seeds' pictures tells; NaN: one seed
	bool resolved; // relmse is above the upper end that the reference's own has by its reply: only then it takes part in
		       // comparisons
	double rmse, mean_difference, flip, flip_max; // mean over seeds; flip's of `shown` alone
	double seconds; // median of the warm runs; NaN: there is none
	struct interval seconds_interval;
	double cold_seconds; // median of the cold ones
	size_t warm_runs, cold_runs;
	double efficiency; // 1 / (relMSE · s); NaN where noise is less than half of relMSE: then more time buys less
	struct interval efficiency_interval;
	bool pareto; // no other point of the view is as accurate and as quick
	struct bias bias;
	double *tiles; // mean luminance of each tile, seed by seed; owned
	double *run_relmse; // of each run, corrected; NaN: it has no image; owned
};

struct reference {
	const struct study_run *run; // NULL: the view has none
	struct picture picture;
	double relmse, low, high; // its own; NaN: unknown
	double exposure_ev; // that shows its 95th percentile of luminance at 0.8
	double *tiles; // mean luminance; owned
};

struct figures {
	struct study *study;
	uint32_t tile, columns, rows;
	struct reference *views; // study->views
	struct point *points; // by view, technique and effects, then by seconds: kind "point"
	size_t point_count;
	struct point *ablations; // kind "ablation"
	size_t ablation_count;
	struct point *colds; // kind "cold"
	size_t cold_count;
};

// Measure a study. What cannot be measured is noted by study_miss, and its figures are NaN. STATUS_MEMORY alone fails.
enum status figures_measure(struct study *study, struct figures *figures, struct error *err);
void figures_finish(struct figures *figures); // a zeroed one is fine

// Whether a technique's error falls with the samples for good (protocol/names.h): then it has no floor. One that this build
// does not know has one.
bool figures_converges(const char *technique);

// Read a run's image, which has the study's size. Failures are those of study_path and picture_read.
enum status figures_picture(const struct study *study, const struct study_run *run, struct picture *picture,
			    struct error *err);

// What is taken off for the reference's own error; 0 if it is unknown.
static inline double figures_own(const struct reference *reference)
{
	return reference->relmse > 0 ? reference->relmse : 0;
}

// What the reference's own error is at most: infinite if an interval is stated that has no upper end, as where light may not
// have been found; the error itself if none is stated.
static inline double figures_own_high(const struct reference *reference)
{
	const double own = figures_own(reference);
	if (isfinite(reference->high))
		return fmax(own, reference->high);
	return isfinite(reference->low) ? (double)INFINITY : own;
}

#endif
