#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/report/results.h"

// What one predictor said of the runs of one technique.
struct tally {
	double ratios[4096]; // predicted over true
	size_t count, with_interval, inside;
};

// Note a prediction in `runs` and the tally: {"run", "of", "from", "predicted", "low", "high", "true"}.
static void note(json_t *runs, struct tally *tally, const struct study_run *run, const char *of, const char *from,
		 const struct study_estimate *said, double truth)
{
	if (!isfinite(said->value) || !isfinite(truth))
		return;
	json_array_append_new(runs, json_pack("{s:s, s:s, s:s, s:s, s:f, s:o, s:o, s:f}", "run", run->id, "technique",
					      run->technique, "of", of, "from", from, "predicted", said->value, "low",
					      results_number(said->low), "high", results_number(said->high), "true", truth));
	if (truth > 0 && said->value > 0 && tally->count < sizeof tally->ratios / sizeof *tally->ratios)
		tally->ratios[tally->count++] = said->value / truth;
	// An interval without an upper end holds whatever is above its lower one.
	if (isfinite(said->low)) {
		tally->with_interval++;
		tally->inside += truth >= said->low && !(truth > said->high);
	}
}

static void summarise(json_t *summary, const char *technique, const char *of, const char *from, struct tally *tally)
{
	if (tally->count == 0)
		return;
	json_t *row = json_pack("{s:s, s:s, s:s, s:i, s:i}", "technique", technique, "of", of, "from", from, "runs",
				(int)tally->count, "with_interval", (int)tally->with_interval);
	json_object_set_new(
	    row, "held",
	    results_number(tally->with_interval ? (double)tally->inside / (double)tally->with_interval : (double)NAN));
	// The factor by which nine of ten were wrong at most, either way.
	double *factors = calloc(tally->count, sizeof *factors);
	for (size_t i = 0; factors && i < tally->count; i++)
		factors[i] = fmax(tally->ratios[i], 1 / tally->ratios[i]);
	if (factors) {
		statistics_median(factors, tally->count); // sorts
		const size_t ninety = (tally->count * 9 + 9) / 10 - 1;
		json_object_set_new(row, "factor_90", results_number(factors[ninety]));
	}
	free(factors);
	json_object_set_new(row, "median_ratio", results_number(statistics_median(tally->ratios, tally->count)));
	json_array_append_new(summary, row);
}

static bool first_of_technique(const struct figures *f, size_t i)
{
	for (size_t k = 0; k < i; k++)
		if (strcmp(f->points[k].runs[0].technique, f->points[i].runs[0].technique) == 0)
			return false;
	return true;
}

// The predictions of one technique, of three kinds: the reply's error, the quote's error, the quote's time. Returns how many
// errors are left out: those of points that are not resolved, for what is left there is the reference's noise.
static size_t add_technique(const struct figures *f, const char *technique, json_t *runs, json_t *summary)
{
	size_t left_out = 0;
	static const char *const kinds[3][2] = {{"relmse", "reply"}, {"relmse", "quote"}, {"seconds", "quote"}};
	struct tally *tallies = calloc(3, sizeof *tallies);
	for (size_t i = 0; tallies && i < f->point_count; i++) {
		const struct point *p = &f->points[i];
		if (strcmp(p->runs[0].technique, technique) != 0)
			continue;
		for (size_t r = 0; r < p->count; r++) {
			const struct study_run *run = &p->runs[r];
			const double truth = p->resolved ? p->run_relmse[r] : (double)NAN;
			if (!p->resolved && isfinite(p->run_relmse[r]))
				left_out +=
				    (size_t)(isfinite(run->error.value) != 0) + (isfinite(run->quoted_relmse.value) != 0);
			note(runs, &tallies[0], run, kinds[0][0], run->error_kind, &run->error, truth);
			note(runs, &tallies[1], run, kinds[1][0], run->quoted_from, &run->quoted_relmse, truth);
			note(runs, &tallies[2], run, kinds[2][0], run->quoted_from, &run->quoted_seconds, run->seconds);
		}
	}
	for (size_t k = 0; tallies && k < 3; k++)
		summarise(summary, technique, kinds[k][0], kinds[k][1], &tallies[k]);
	free(tallies);
	return left_out;
}

json_t *predictions_json(const struct figures *f)
{
	json_t *runs = json_array(), *summary = json_array();
	size_t left_out = 0;
	for (size_t i = 0; i < f->point_count; i++)
		if (first_of_technique(f, i))
			left_out += add_technique(f, f->points[i].runs[0].technique, runs, summary);
	return json_pack("{s:o, s:o, s:I}", "summary", summary, "runs", runs, "not_resolved", (json_int_t)left_out);
}

// The point with all effects beside which one was switched off.
static const struct point *whole_of(const struct figures *f, const struct point *p)
{
	const struct study_run *run = &p->runs[0];
	for (size_t i = 0; i < f->point_count; i++) {
		const struct study_run *other = &f->points[i].runs[0];
		if (other->view == run->view && strcmp(other->technique, run->technique) == 0 &&
		    json_equal(other->settings, run->settings) && strcmp(other->effects, run->effects) != 0)
			return &f->points[i];
	}
	return NULL;
}

json_t *ablation_json(const struct figures *f)
{
	json_t *ablation = json_array();
	for (size_t i = 0; i < f->ablation_count; i++) {
		const struct point *p = &f->ablations[i], *whole = whole_of(f, p);
		const struct study_run *run = &p->runs[0];
		json_t *row = json_pack("{s:i, s:s, s:s, s:O, s:s}", "view", (int)run->view, "technique", run->technique,
					"effects", run->effects, "settings", run->settings, "command", run->command);
		const double figures[] = {p->seconds, p->relmse, whole ? whole->seconds : (double)NAN,
					  whole ? whole->relmse : (double)NAN};
		const double derived[] = {figures[2] - figures[0], (figures[2] - figures[0]) / figures[2],
					  figures[1] - figures[3], p->mean_difference};
		static const char *const names[] = {"seconds", "relmse", "seconds_whole", "relmse_whole"};
		static const char *const more[] = {"seconds_saved", "share_saved", "relmse_incurred", "mean_difference"};
		for (size_t k = 0; k < 4; k++) {
			json_object_set_new(row, names[k], results_number(figures[k]));
			json_object_set_new(row, more[k], results_number(derived[k]));
		}
		json_array_append_new(ablation, row);
	}
	return ablation;
}
