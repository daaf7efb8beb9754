#include "server/report/figures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/names.h"
#include "server/base/checked.h"
#include "server/base/luminance.h"
#include "server/compare/comparison.h"
#include "server/report/bias.h"

bool figures_converges(const char *technique)
{
	const int number = technique_number(technique, strlen(technique));
	return number >= 0 && (technique_traits((unsigned)number) & TECHNIQUE_NOISE) != 0;
}

enum status figures_picture(const struct study *study, const struct study_run *run, struct picture *picture,
			    struct error *err)
{
	*picture = (struct picture){0};
	if (!run->image)
		return error_set(err, STATUS_IO, "it has no image");
	char *path = study_path(study, run->image, err);
	if (!path)
		return err->code;
	enum status s = picture_read(path, picture, err);
	free(path);
	if (s == STATUS_OK && (picture->width != study->width || picture->height != study->height)) {
		s = error_set(err, STATUS_BAD_ARGUMENT, "its image has %u x %u pixels, the study %u x %u", picture->width,
			      picture->height, study->width, study->height);
		picture_finish(picture);
	}
	return s;
}

// ---- references ----

static int ascending(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

static double exposure_of(const struct picture *p)
{
	const size_t pixels = (size_t)p->width * p->height;
	float *sorted = malloc(pixels * sizeof *sorted);
	size_t count = 0;
	for (size_t i = 0; sorted && i < pixels; i++) {
		const double l = luminance(p->rgb + 3 * i);
		if (isfinite(l) && l > 0)
			sorted[count++] = (float)l;
	}
	double ev = 0;
	if (count > 0) {
		qsort(sorted, count, sizeof *sorted, ascending);
		ev = log2(0.8 / (double)sorted[(count - 1) * 19 / 20]);
	}
	free(sorted);
	return fmin(fmax(ev, -LIMIT_EXPOSURE_EV), LIMIT_EXPOSURE_EV);
}

static enum status read_reference(struct figures *f, uint32_t view, struct error *err)
{
	struct reference *reference = &f->views[view];
	struct study *study = f->study;
	char name[32];
	*reference = (struct reference){.relmse = (double)NAN, .low = (double)NAN, .high = (double)NAN};
	for (size_t i = 0; i < study->run_count; i++) {
		const struct study_run *run = &study->runs[i];
		// Of several the one with the most samples.
		if (run->kind == STUDY_REFERENCE && run->view == view &&
		    (!reference->run || run->samples > reference->run->samples))
			reference->run = run;
	}
	if (!reference->run) {
		study_miss(study, NULL, "%s has no reference: none of its errors is known",
			   study_view_name(study, view, name));
		return STATUS_OK;
	}
	if (figures_picture(study, reference->run, &reference->picture, err) != STATUS_OK) {
		study_miss(study, reference->run->id, "the reference cannot be read: %s", err->text);
		reference->run = NULL;
		return err->code == STATUS_MEMORY ? STATUS_MEMORY : STATUS_OK;
	}
	reference->relmse = reference->run->error.value;
	reference->low = reference->run->error.low;
	reference->high = reference->run->error.high;
	if (isinf(figures_own_high(reference)))
		study_miss(study, reference->run->id,
			   "the reference's own error has no upper end, so no error of %s is resolved",
			   study_view_name(study, view, name));
	reference->exposure_ev = exposure_of(&reference->picture);
	reference->tiles = calloc((size_t)f->columns * f->rows, sizeof *reference->tiles);
	if (!reference->tiles)
		return error_set(err, STATUS_MEMORY, "no memory for the tiles of a reference");
	bias_tiles(f, &reference->picture, reference->tiles);
	return STATUS_OK;
}

// ---- points ----

static double correct(double measured, const struct reference *reference)
{
	return fmax(0, measured - figures_own(reference));
}

// What measuring needs beside a point: buffers for one picture, and sums over the seeds of the point at hand.
struct sums {
	float *error; // the map of one picture
	struct picture mean; // the seeds' pictures, added up
	double relmse[RUNS_OF_POINT]; // of each seed, as measured
	double rmse, difference;
};

static void add_picture(struct picture *mean, const struct picture *picture, bool first)
{
	const size_t values = 3 * (size_t)picture->width * picture->height;
	for (size_t i = 0; i < values; i++)
		mean->rgb[i] = (first ? 0 : mean->rgb[i]) + picture->rgb[i];
}

// Measure the image of one run. Without one that holds, its figures stay unknown.
static enum status measure_run(struct figures *f, struct point *p, const struct study_run *run, struct sums *sums,
			       struct error *err)
{
	const struct reference *reference = &f->views[run->view];
	struct picture picture;
	struct comparison comparison;
	enum status s = figures_picture(f->study, run, &picture, err);
	if (s == STATUS_OK) {
		s = p->shown || run->kind != STUDY_POINT ? metrics_compare(&picture, &reference->picture, (double)INFINITY,
									   &comparison.metrics, sums->error, err)
							 : comparison_make(&picture, &reference->picture, (double)INFINITY,
									   &comparison, sums->error, NULL, err);
	}
	if (s != STATUS_OK) {
		picture_finish(&picture);
		if (s != STATUS_MEMORY)
			study_miss(f->study, run->id, "%s", err->text);
		return s == STATUS_MEMORY ? s : STATUS_OK;
	}
	if (!p->shown) {
		p->shown = run;
		if (run->kind == STUDY_POINT) {
			p->flip = comparison.flip.mean;
			p->flip_max = comparison.flip.max;
		}
	}
	if (comparison.metrics.non_finite_a > 0)
		study_miss(f->study, run->id, "%llu pixels are not finite and do not count",
			   (unsigned long long)comparison.metrics.non_finite_a);
	bias_tiles(f, &picture, p->tiles + p->seeds * f->columns * f->rows);
	add_picture(&sums->mean, &picture, p->seeds == 0);
	sums->relmse[p->seeds++] = comparison.metrics.relmse;
	sums->rmse += comparison.metrics.rmse;
	sums->difference += comparison.metrics.mean_difference;
	p->run_relmse[run - p->runs] = correct(comparison.metrics.relmse, reference);
	picture_finish(&picture);
	return STATUS_OK;
}

// Times by warm and by cold runs; the efficiency by the first warm run of each seed that has an error.
static void time_point(struct point *p)
{
	double warm[RUNS_OF_POINT], cold[RUNS_OF_POINT], costs[RUNS_OF_POINT];
	size_t both = 0;
	for (size_t i = 0; i < p->count; i++) {
		const struct study_run *run = &p->runs[i];
		if (!isfinite(run->seconds))
			continue;
		if (!run->warm) {
			cold[p->cold_runs++] = run->seconds;
			continue;
		}
		warm[p->warm_runs++] = run->seconds;
		if (p->run_relmse[i] > 0 && (i == 0 || run[-1].seed != run->seed))
			costs[both++] = p->run_relmse[i] * run->seconds;
	}
	p->seconds_interval = statistics_median_interval(warm, p->warm_runs);
	p->seconds = statistics_median(warm, p->warm_runs);
	p->cold_seconds = statistics_median(cold, p->cold_runs);
	p->efficiency = (double)NAN;
	p->efficiency_interval = (struct interval){(double)NAN, (double)NAN};
	if (p->resolved && p->relmse_noise >= p->relmse / 2) {
		const struct interval cost = statistics_mean_interval(costs, both);
		p->efficiency = 1 / (p->relmse * p->seconds);
		if (cost.low > 0)
			p->efficiency_interval =
			    (struct interval){fmin(1 / cost.high, p->efficiency), fmax(1 / cost.low, p->efficiency)};
	}
}

// How much of the error the mean of the seeds' pictures has lost: of a variance the mean of n has 1/n left.
static enum status find_noise(struct point *p, const struct reference *reference, struct sums *sums, struct error *err)
{
	const size_t values = 3 * (size_t)sums->mean.width * sums->mean.height;
	const double n = (double)p->seeds;
	struct metrics metrics;
	for (size_t i = 1; i < p->seeds; i++)
		p->noise = p->noise || sums->relmse[i] != sums->relmse[0];
	p->relmse_noise = p->seeds > 1 ? 0 : (double)NAN;
	if (!p->noise)
		return STATUS_OK;
	for (size_t i = 0; i < values; i++)
		sums->mean.rgb[i] /= (float)n;
	const enum status s =
	    metrics_compare(&sums->mean, &reference->picture, (double)INFINITY, &metrics, sums->error, err);
	// Where every pixel is no number in one seed or the other, their mean has none.
	p->relmse_noise = s == STATUS_OK ? fmax(0, (p->relmse_measured - metrics.relmse) * n / (n - 1)) : (double)NAN;
	return s == STATUS_MEMORY ? s : STATUS_OK;
}

// A reply states an interval of 90 %, those here are of 95 %: that of a normal error has ends so many times as far off.
#define OWN_WIDER (1.960 / 1.645)

static enum status finish_errors(struct point *p, const struct reference *reference, struct sums *sums, struct error *err)
{
	const double own = figures_own(reference);
	const double own_high = figures_own_high(reference), highest = own + OWN_WIDER * (own_high - own);
	const double lowest = reference->low < own ? own - OWN_WIDER * (own - reference->low) : own;
	p->relmse_measured = statistics_mean(sums->relmse, p->seeds);
	p->relmse = correct(p->relmse_measured, reference);
	p->resolved = p->relmse >= own_high && p->relmse > 0;
	p->rmse = sums->rmse / (double)p->seeds;
	p->mean_difference = sums->difference / (double)p->seeds;
	const struct interval measured = statistics_mean_interval(sums->relmse, p->seeds);
	if (isfinite(measured.low) && isfinite(measured.high)) {
		p->seeds_interval = (struct interval){fmax(0, measured.low - own), fmax(0, measured.high - own)};
		p->relmse_interval =
		    (struct interval){fmax(0, measured.low - highest), fmax(0, measured.high - fmax(0, lowest))};
	}
	return find_noise(p, reference, sums, err);
}

static enum status measure_point(struct figures *f, struct point *p, struct sums *sums, struct error *err)
{
	const struct reference *reference = &f->views[p->runs[0].view];
	const size_t tiles = (size_t)f->columns * f->rows;
	size_t room;
	if (!checked_mul(p->count, tiles, &room))
		return error_set(err, STATUS_LIMIT, "a point has too many runs");
	p->tiles = calloc(room, sizeof *p->tiles);
	p->run_relmse = calloc(p->count, sizeof *p->run_relmse);
	if (!p->tiles || !p->run_relmse)
		return error_set(err, STATUS_MEMORY, "no memory for the figures of a point");
	p->relmse = p->relmse_measured = p->rmse = p->mean_difference = p->flip = p->flip_max = (double)NAN;
	p->relmse_noise = (double)NAN;
	p->relmse_interval = p->seeds_interval = (struct interval){(double)NAN, (double)NAN};
	sums->rmse = sums->difference = 0;
	enum status s = STATUS_OK;
	for (size_t i = 0; i < p->count && s == STATUS_OK; i++) {
		const struct study_run *run = &p->runs[i];
		const bool again = i > 0 && run[-1].seed == run->seed && isfinite(p->run_relmse[i - 1]);
		p->run_relmse[i] = again ? p->run_relmse[i - 1] : (double)NAN; // the same seed has the same picture
		if (reference->run && run->kind != STUDY_COLD && !again)
			s = measure_run(f, p, run, sums, err);
	}
	if (p->seeds > 0 && s == STATUS_OK)
		s = finish_errors(p, reference, sums, err);
	time_point(p);
	return s;
}

// ---- all of them ----

static int by_time(const void *a, const void *b)
{
	const struct point *x = a, *y = b;
	if (x->runs[0].view != y->runs[0].view)
		return x->runs[0].view > y->runs[0].view ? 1 : -1;
	const int technique = strcmp(x->runs[0].technique, y->runs[0].technique);
	const int effects = technique ? technique : strcmp(x->runs[0].effects, y->runs[0].effects);
	if (effects)
		return effects;
	// Unknown times come last.
	if (!isfinite(x->seconds) || !isfinite(y->seconds))
		return isfinite(y->seconds) - isfinite(x->seconds);
	return (x->seconds > y->seconds) - (x->seconds < y->seconds);
}

// The points of one kind; the runs are sorted by group.
static enum status collect(struct figures *f, enum study_kind kind, struct point **points, size_t *count, struct sums *sums,
			   struct error *err)
{
	struct study *study = f->study;
	*points = calloc(study->run_count + 1, sizeof **points);
	if (!*points)
		return error_set(err, STATUS_MEMORY, "no memory for the points");
	enum status s = STATUS_OK;
	for (size_t i = 0; i < study->run_count && s == STATUS_OK;) {
		size_t end = i + 1;
		while (end < study->run_count && end - i < RUNS_OF_POINT &&
		       strcmp(study->runs[i].group, study->runs[end].group) == 0)
			end++;
		if (study->runs[i].kind == kind) {
			struct point *p = &(*points)[(*count)++];
			*p = (struct point){.runs = &study->runs[i], .count = end - i};
			s = measure_point(f, p, sums, err);
		}
		i = end;
	}
	if (*count > 0)
		qsort(*points, *count, sizeof **points, by_time);
	return s;
}

// What is not resolved is not on the front, though it beats what is.
static void mark_pareto(struct figures *f)
{
	for (size_t i = 0; i < f->point_count; i++) {
		struct point *p = &f->points[i];
		p->pareto = isfinite(p->seconds) && p->resolved;
		for (size_t k = 0; k < f->point_count && p->pareto; k++) {
			const struct point *q = &f->points[k];
			const bool as_good = q->seconds <= p->seconds && q->relmse <= p->relmse;
			const bool better = q->seconds < p->seconds || q->relmse < p->relmse;
			p->pareto = q->runs[0].view != p->runs[0].view || !as_good || !better;
		}
	}
}

enum status figures_measure(struct study *study, struct figures *f, struct error *err)
{
	const uint32_t longer = study->width > study->height ? study->width : study->height;
	const uint32_t tile = (longer + TILES_MOST - 1) / TILES_MOST;
	*f = (struct figures){.study = study, .tile = tile < TILE_LEAST ? TILE_LEAST : tile};
	f->columns = (study->width + f->tile - 1) / f->tile;
	f->rows = (study->height + f->tile - 1) / f->tile;
	f->views = calloc(study->views, sizeof *f->views);
	const size_t pixels = (size_t)study->width * study->height;
	struct sums *sums = calloc(1, sizeof *sums);
	if (sums) {
		sums->error = malloc(pixels * sizeof *sums->error);
		sums->mean = (struct picture){
		    .width = study->width, .height = study->height, .rgb = malloc(3 * pixels * sizeof *sums->mean.rgb)};
	}
	enum status s = f->views && sums && sums->error && sums->mean.rgb
			    ? STATUS_OK
			    : error_set(err, STATUS_MEMORY, "no memory for the figures");
	for (uint32_t view = 0; view < study->views && s == STATUS_OK; view++)
		s = read_reference(f, view, err);
	if (s == STATUS_OK)
		s = collect(f, STUDY_POINT, &f->points, &f->point_count, sums, err);
	if (s == STATUS_OK)
		s = collect(f, STUDY_ABLATION, &f->ablations, &f->ablation_count, sums, err);
	if (s == STATUS_OK)
		s = collect(f, STUDY_COLD, &f->colds, &f->cold_count, sums, err);
	if (s == STATUS_OK)
		s = bias_find(f, err);
	if (s == STATUS_OK)
		mark_pareto(f);
	if (sums) {
		free(sums->error);
		free(sums->mean.rgb);
	}
	free(sums);
	return s;
}

static void finish_points(struct point *points, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		free(points[i].tiles);
		free(points[i].run_relmse);
		free(points[i].bias.difference);
		free(points[i].bias.biased);
	}
	free(points);
}

void figures_finish(struct figures *f)
{
	for (uint32_t view = 0; f->views && view < f->study->views; view++) {
		picture_finish(&f->views[view].picture);
		free(f->views[view].tiles);
	}
	free(f->views);
	finish_points(f->points, f->point_count);
	finish_points(f->ablations, f->ablation_count);
	finish_points(f->colds, f->cold_count);
	*f = (struct figures){0};
}
