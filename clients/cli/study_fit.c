// What fits into the budget. A few first runs, which are runs of the plan like all others, tell how long the scene takes and
// how noisy it is; from these follow how many samples points have and where the reference ends.
// The relMSE of N samples is taken as that of a run that was measured times its samples over N: the variance of a mean.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/study.h"

// What is left of the budget is for the reference, for leaving effects out, and the rest for points: of these half at most
// for techniques without noise, so that the curve of one with noise gets as far as theirs.
#define REFERENCE_SHARE 0.4
#define ABLATION_SHARE 0.12
#define EXACT_SHARE 0.5
#define COUNT_SHARE 0.3 // of these, what one count of samples of the defaults may take
#define REFERENCE_SAMPLES_MAX 65536u
#define RUNG 4u // from one number of samples to the next
#define RUNGS_MIN 2u // a line needs two points
#define RUNGS_MAX 8u
#define PROBE_SAMPLES 16u // of the run that tells the noise
#define EXACT_SAMPLES 4u // of the second run of a technique without any, which tells the cost of a sample

// ---- measuring -------------------------------------------------------------------------------------------------------

static uint32_t find_plain(const struct study *study, unsigned technique, uint32_t samples)
{
	uint32_t i = 0;
	while (i < study->plan.point_count && !study_is_plain(&study->plan.points[i], technique, samples))
		i++;
	return i;
}

static enum exit_code measure(struct study *study, unsigned technique, uint32_t samples, uint32_t view)
{
	struct study_run cold, run;
	const struct study_point point = {.kind = STUDY_POINT, .technique = technique, .samples = samples, .probe = true};
	if (find_plain(study, technique, samples) == study->plan.point_count && !study_add_point(&study->plan, &point))
		return EXIT_DONE;
	const uint32_t at = find_plain(study, technique, samples);
	study_make_run(study, STUDY_COLD, view, at, 0, &cold);
	study_make_run(study, STUDY_POINT, view, at, 1, &run);
	study_find_run(study, &cold);
	study_find_run(study, &run);
	// One cold run of the fewest samples is enough; of a technique without noise one a view, for what it keeps of it.
	if (samples == 1 && (!study_has_noise(technique) || view == 0)) {
		const enum exit_code code = run.done ? EXIT_DONE : study_make(study, &cold);
		if (code != EXIT_DONE)
			return code;
	}
	return study_make(study, &run);
}

// What a run's report says, negative if it says nothing: a number by its key.
static double report_number(struct study *study, unsigned technique, uint32_t samples, uint32_t view, const char *key)
{
	struct study_run run;
	const uint32_t at = find_plain(study, technique, samples);
	if (at == study->plan.point_count)
		return -1;
	study_make_run(study, STUDY_POINT, view, at, 1, &run);
	const json_t *report = json_object_get(json_object_get(study->lines, run.id), "report");
	const json_t *value = json_object_get(report, key);
	return json_is_number(value) ? json_number_value(value) : -1;
}

// ---- settling --------------------------------------------------------------------------------------------------------

// Settle the reference of a view that a number of seconds is for.
static void settle_reference(struct study *study, uint32_t view, double seconds)
{
	struct study_view *v = &study->plan.views[view];
	const unsigned technique = (unsigned)technique_with(TECHNIQUE_RENDERS | TECHNIQUE_NOISE);
	const struct study_line line = study_line_of(study, technique, view);
	const double high = report_number(study, technique, PROBE_SAMPLES, view, "relmse_high"),
		     middle = report_number(study, technique, PROBE_SAMPLES, view, "estimated_relmse");
	const double error = high > 0 ? high : 3 * middle;
	double samples = line.known ? (seconds - line.a) / line.b : 64;
	samples = fmin(fmax(samples, 2.0 * PROBE_SAMPLES), REFERENCE_SAMPLES_MAX / 1.5);
	if (v->relmse == 0 && error > 0)
		v->relmse = study_round(error * PROBE_SAMPLES / samples, 2);
	else if (v->relmse > 0 && error > 0)
		samples = error * PROBE_SAMPLES / v->relmse; // the plan file's own target
	if (v->relmse == 0)
		v->relmse = 1e-6; // the noise is not known: the samples end it
	if (v->samples == 0)
		v->samples = (uint32_t)fmin(fmax(1.5 * samples, 2.0 * PROBE_SAMPLES), REFERENCE_SAMPLES_MAX);
}

// Seconds of all seeds and views of N samples.
static double rung_cost(const struct study *study, const struct study_point *point, uint32_t samples)
{
	double seconds = 0;
	for (uint32_t v = 0; v < study->plan.view_count; v++) {
		const struct study_line line = study_line_of(study, point->technique, v);
		seconds += (line.known ? line.a + line.b * samples : 1.0) * study_seeds_of(&study->plan, point);
	}
	return seconds;
}

static void drop_point(struct study_plan *plan, uint32_t at)
{
	memmove(&plan->points[at], &plan->points[at + 1], (plan->point_count - at - 1) * sizeof(*plan->points));
	plan->point_count--;
}

// Put points of 1, 4, 16… samples, as many as fit into a number of seconds, in the place of one that fits itself; where a
// whole rung does not fit, half of it.
static bool spread_samples(struct study *study, uint32_t at, double seconds)
{
	struct study_point point = study->plan.points[at];
	struct study_plan *plan = &study->plan;
	double spent = 0;
	drop_point(plan, at);
	point.samples = 1;
	for (uint32_t i = 0; i < RUNGS_MAX; i++, point.samples *= RUNG) {
		const bool whole = i < RUNGS_MIN || spent + rung_cost(study, &point, point.samples) <= seconds;
		if (!whole)
			point.samples /= 2;
		if (!whole && spent + rung_cost(study, &point, point.samples) > seconds)
			break;
		spent += rung_cost(study, &point, point.samples);
		if (!study_add_point(plan, &point))
			return false;
		if (!whole)
			break;
	}
	return true;
}

// The most samples of a technique's plain points whose ablations fit into a number of seconds each.
static uint32_t ablation_samples(const struct study *study, unsigned technique, double seconds)
{
	uint32_t samples = 1;
	for (uint32_t i = 0; i < study->plan.point_count; i++) {
		const struct study_point *p = &study->plan.points[i];
		if (!study_has_noise(technique) && p->samples > EXACT_SAMPLES)
			continue;
		if (study_is_plain(p, technique, p->samples) && p->samples > samples &&
		    rung_cost(study, p, p->samples) <= seconds)
			samples = p->samples;
	}
	return samples;
}

static const char *text_of(const json_t *object, const char *key)
{
	const char *text = json_string_value(json_object_get(object, key));
	return text ? text : "";
}

// Add a point without each effect that a technique has simulated.
static bool add_ablations(struct study *study, unsigned technique, double seconds)
{
	struct study_run run;
	size_t index, simulated = 0;
	json_t *effect;
	const uint32_t at = find_plain(study, technique, 1);
	if (at == study->plan.point_count)
		return true;
	study_make_run(study, STUDY_POINT, 0, at, 1, &run);
	const json_t *report = json_object_get(json_object_get(study->lines, run.id), "report");
	json_t *effects = json_object_get(report, "effects");
	json_array_foreach(effects, index, effect) simulated += strcmp(text_of(effect, "state"), "simulated") == 0;
	struct study_point point = {.kind = STUDY_ABLATION, .technique = technique};
	point.samples = simulated > 0 ? ablation_samples(study, technique, seconds / (double)simulated) : 1;
	// What the ablations stand beside is a point of the plan, though it was made to be measured alone.
	const uint32_t whole = find_plain(study, technique, point.samples);
	if (simulated > 0 && whole < study->plan.point_count)
		study->plan.points[whole].probe = false;
	json_array_foreach(effects, index, effect)
	{
		if (strcmp(text_of(effect, "state"), "simulated") != 0)
			continue;
		snprintf(point.effects, sizeof(point.effects), "%s,-%.31s",
			 study->texts.effects[0] ? study->texts.effects : "auto", text_of(effect, "name"));
		if (!study_add_point(&study->plan, &point))
			return false;
	}
	return true;
}

static enum exit_code measure_all(struct study *study)
{
	enum exit_code code = EXIT_DONE;
	const unsigned reference = (unsigned)technique_with(TECHNIQUE_RENDERS | TECHNIQUE_NOISE);
	for (uint32_t v = 0; code == EXIT_DONE && v < study->plan.view_count; v++) {
		for (unsigned t = 1; code == EXIT_DONE && t < TECHNIQUE_COUNT; t++) {
			const bool asked = study->techniques & 1u << t;
			if (!asked && !(t == reference && study->plan.reference))
				continue;
			code = measure(study, t, 1, v);
			if (code == EXIT_DONE)
				code = measure(study, t, study_has_noise(t) ? PROBE_SAMPLES : EXACT_SAMPLES, v);
		}
	}
	return code;
}

static double cost_of(const struct study *study, uint32_t point)
{
	const struct study_point *p = &study->plan.points[point];
	double seconds = 0;
	for (uint32_t v = 0; v < study->plan.view_count; v++)
		seconds += study_predict(study, point, v) * study_seeds_of(&study->plan, p) +
			   (study_is_first(&study->plan, point) ? study_predict_cold(study, point, v) : 0);
	return seconds;
}

// Seconds of all runs of the points without noise.
static double exact_cost(const struct study *study)
{
	double seconds = 0;
	for (uint32_t i = 0; i < study->plan.point_count; i++)
		if (!study_has_noise(study->plan.points[i].technique))
			seconds += cost_of(study, i);
	return seconds;
}

// The dearest point without noise, of the defaults with many samples or of a setting. point_count: there is none.
static uint32_t dearest(const struct study *study, bool plain)
{
	uint32_t found = study->plan.point_count;
	for (uint32_t i = 0; i < study->plan.point_count; i++) {
		const struct study_point *p = &study->plan.points[i];
		if (study_has_noise(p->technique) || (p->setting_count == 0) != plain ||
		    (plain && p->samples <= EXACT_SAMPLES))
			continue;
		if (found == study->plan.point_count || cost_of(study, i) >= cost_of(study, found))
			found = i;
	}
	return found;
}

// Take points without noise out until the others take at most so many seconds: counts of samples of the defaults that would
// leave nothing for settings, then the dearest settings, then the other counts.
static void drop_points(struct study *study, double seconds)
{
	struct study_plan *plan = &study->plan;
	for (uint32_t at; (at = dearest(study, true)) < plan->point_count && cost_of(study, at) > COUNT_SHARE * seconds;)
		drop_point(plan, at);
	for (int plain = 0; plain < 2; plain++)
		for (uint32_t at; exact_cost(study) > seconds && (at = dearest(study, plain)) < plan->point_count;) {
			drop_point(plan, at);
			plan->left_out += !plain;
		}
}

// Take out what was measured alone and is no point of the plan.
static void drop_probes(struct study *study)
{
	struct study_plan *plan = &study->plan;
	uint32_t kept = 0;
	for (uint32_t i = 0; i < plan->point_count; i++)
		if (!plan->points[i].probe)
			plan->points[kept++] = plan->points[i];
	plan->point_count = kept;
	study->has_last = false; // the numbers of points are others now
}

static bool settle(struct study *study)
{
	struct study_plan *plan = &study->plan;
	const double begun = study_clock() - study->started;
	double left = fmax(plan->budget_s - study_predict_report(study) - begun, 0.2 * plan->budget_s);
	if (!study->texts.plan) { // a plan file says itself what is wanted
		drop_points(study, left * (1 - REFERENCE_SHARE - (plan->ablations ? ABLATION_SHARE : 0)) * EXACT_SHARE);
		left = fmax(plan->budget_s - study_predict_report(study) - begun, 0.2 * plan->budget_s);
	}
	unsigned fitted = 0;
	for (uint32_t i = 0; i < plan->point_count; i++)
		fitted += plan->points[i].samples == STUDY_SAMPLES_FIT;
	for (uint32_t v = 0; plan->reference && v < plan->view_count; v++)
		settle_reference(study, v, left * REFERENCE_SHARE / plan->view_count);
	const double ablations = plan->ablations ? left * ABLATION_SHARE : 0;
	const double rest = left * (1 - REFERENCE_SHARE) - ablations,
		     points = fmax(rest - exact_cost(study), (1 - EXACT_SHARE) * rest);
	for (uint32_t i = 0; i < plan->point_count;) {
		if (plan->points[i].samples != STUDY_SAMPLES_FIT)
			i++;
		else if (!spread_samples(study, i, points / fitted))
			return false;
	}
	for (unsigned t = 1; plan->ablations && t < TECHNIQUE_COUNT; t++)
		if ((study->techniques & 1u << t) && !add_ablations(study, t, ablations / (study_has_noise(t) ? 1 : 4)))
			return false;
	drop_probes(study);
	study_sort_points(plan);
	return true;
}

enum exit_code study_fit(struct study *study)
{
	bool open = study->plan.ablations;
	for (uint32_t i = 0; i < study->plan.point_count; i++)
		open |= study->plan.points[i].samples == STUDY_SAMPLES_FIT;
	for (uint32_t v = 0; study->plan.reference && v < study->plan.view_count; v++)
		open |= study->plan.views[v].relmse == 0 || study->plan.views[v].samples == 0;
	if (!open)
		return EXIT_DONE;
	const enum exit_code code = measure_all(study);
	if (code != EXIT_DONE)
		return code;
	if (!settle(study)) {
		const struct candil_error error = {.code = CANDIL_STATUS_LIMIT,
						   .text = "the plan has too many points: name fewer in a plan file"};
		return job_fail(&study->job, &error);
	}
	return EXIT_DONE;
}
