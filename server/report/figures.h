// The figures of a study: what its images are worth beside the reference of their view, run by run and point by point. A
// point is the runs of one view, technique, set of settings and effects, over their seeds. One thread; an image is in memory
// only while it is measured, the references all the time.
//
// A reference has noise of its own, and the relMSE of a picture beside it is too high by the reference's own relMSE: with x
// and r independent and E r = t, E (x − r)² = E (x − t)² + E (r − t)². So that is taken off wherever it is known, and what
// is left is never below 0. Where it is less than the reference's own the point is not resolved: the reference is too noisy
// to tell its error. RMSE and FLIP stay as they are measured, and so does the signed mean, which noise does not move.
#ifndef CANDIL_REPORT_FIGURES_H
#define CANDIL_REPORT_FIGURES_H

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
// of the same view's picture with the most samples of a technique with noise, over that one's seeds, times the ratio of the
// samples: variance falls as 1/N. A technique without noise is a sample of one value. Of the tiles told from noise at most
// BIAS_ALPHA are by chance.
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
	const struct study_run *shown; // whose image is shown and whose FLIP it is: the first with an image; NULL: none
	bool noise; // of its technique
	size_t seeds; // with an image, each counted once
	double relmse, relmse_measured; // mean over seeds, corrected and not
	struct interval relmse_interval; // of the corrected mean; equal to it for a technique without noise
	bool resolved;
	double rmse, mean_difference, flip, flip_max; // mean over seeds; flip's of `shown` alone
	double seconds; // median of the warm runs; NaN: there is none
	struct interval seconds_interval;
	double cold_seconds; // median of the cold ones
	size_t warm_runs, cold_runs;
	double efficiency; // 1 / (relMSE · s)
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

// Whether a technique's error falls with the samples (protocol/names.h). One that this build does not know has no noise.
bool figures_noise(const char *technique);

// Read a run's image, which has the study's size. Failures are those of study_path and picture_read.
enum status figures_picture(const struct study *study, const struct study_run *run, struct picture *picture,
			    struct error *err);

// The value that is not to be told from 0 with this reference: below it nothing is resolved; 0 if it is unknown.
static inline double figures_least(const struct reference *reference)
{
	return reference->relmse > 0 ? reference->relmse : 0;
}

#endif
