// How long runs will take, by what was measured so far. The time of N samples is taken as a + b N.
#include <math.h>

#include "clients/cli/study.h"

// A run that was never made takes so much longer than the technique's plain one, nobody knows why yet.
#define UNKNOWN_FACTOR 1.5
#define UNKNOWN_S 1.0
// What the report takes: at all, and of a million pixels for each point and each run. FLIP is the most of it.
#define REPORT_S 3.0
#define GROUP_S 4.0
#define RUN_S 0.2
#define FITTED_POINTS 6.0 // that one which is not fitted yet becomes, about
#define VARIANT_SHARE 0.3 // of the compilation of a technique's first programs that another setting's takes

static double mean_of(const struct study_times *times)
{
	return times->runs > 0 ? times->seconds / times->runs : -1;
}

// The line through what was measured of a technique's plain points, by the least and the most samples.
struct study_line study_line_of(const struct study *study, unsigned technique, uint32_t view)
{
	const struct study_point *least = NULL, *most = NULL;
	struct study_line line = {0, 0, false};
	for (uint32_t i = 0; i < study->plan.point_count; i++) {
		const struct study_point *p = &study->plan.points[i];
		if (p->technique != technique || p->setting_count > 0 || p->kind != STUDY_POINT || p->times[view].runs == 0)
			continue;
		least = !least || p->samples < least->samples ? p : least;
		most = !most || p->samples > most->samples ? p : most;
	}
	if (!most)
		return line;
	line.known = true;
	const double t = mean_of(&most->times[view]);
	if (least->samples < most->samples)
		line.b = (t - mean_of(&least->times[view])) / (most->samples - least->samples);
	if (!(line.b > 0))
		line.b = t / most->samples;
	line.a = fmax(0, t - line.b * most->samples);
	return line;
}

double study_predict(const struct study *study, uint32_t point, uint32_t view)
{
	const struct study_point *p = &study->plan.points[point];
	for (uint32_t v = view, n = 0; n < study->plan.view_count; n++, v = (v + 1) % study->plan.view_count)
		if (p->times[v].runs > 0)
			return mean_of(&p->times[v]);
	for (uint32_t v = view, n = 0; n < study->plan.view_count; n++, v = (v + 1) % study->plan.view_count) {
		const struct study_line line = study_line_of(study, p->technique, v);
		const bool plain = p->setting_count == 0 && p->kind == STUDY_POINT;
		if (line.known && study_has_noise(p->technique))
			return (line.a + line.b * p->samples) * (plain ? 1 : UNKNOWN_FACTOR);
		if (line.known)
			return plain ? line.a + line.b * p->samples : (line.a + line.b) * UNKNOWN_FACTOR;
	}
	return UNKNOWN_S;
}

double study_predict_reference(const struct study *study, uint32_t view)
{
	const struct study_line line =
	    study_line_of(study, (unsigned)technique_with(TECHNIQUE_RENDERS | TECHNIQUE_NOISE), view);
	const struct study_view *v = &study->plan.views[view];
	// It ends before it has all samples that it may have.
	return line.known ? line.a + line.b * v->samples / 1.5 : UNKNOWN_S;
}

double study_predict_cold(const struct study *study, uint32_t point, uint32_t view)
{
	const unsigned t = study->plan.points[point].technique;
	return fmax(study_predict(study, point, view), study->ready_s[t]) + VARIANT_SHARE * study->cold_s[t];
}

static double predict_run(const struct study *study, const struct study_run *run)
{
	if (run->kind == STUDY_REFERENCE)
		return study_predict_reference(study, run->view);
	return run->kind == STUDY_COLD ? study_predict_cold(study, run->point, run->view)
				       : study_predict(study, run->point, run->view);
}

double study_left(const struct study *study)
{
	double seconds = 0;
	for (uint32_t i = 0; i < study->run_count; i++)
		if (!study->runs[i].done && !study->runs[i].why[0])
			seconds +=
			    predict_run(study, &study->runs[i]) * (&study->runs[i] == study->now ? 1 - study->fraction : 1);
	return seconds;
}

double study_predict_report(const struct study *study)
{
	const struct study_plan *plan = &study->plan;
	const double megapixels = plan->width * (double)plan->height * 1e-6;
	double runs = plan->view_count, groups = plan->view_count;
	for (uint32_t i = 0; i < plan->point_count; i++) {
		const bool fitted = plan->points[i].samples == STUDY_SAMPLES_FIT;
		groups += (fitted ? FITTED_POINTS : 1.0) * plan->view_count;
		runs += (fitted ? FITTED_POINTS : 1.0) * plan->view_count * study_seeds_of(plan, &plan->points[i]);
	}
	return REPORT_S + megapixels * (GROUP_S * groups + RUN_S * runs);
}
