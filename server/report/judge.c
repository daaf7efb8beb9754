#include "server/report/judge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

size_t judge_technique_of(const struct judgement *j, const char *name)
{
	size_t i = 0;
	while (i < j->technique_count && strcmp(j->techniques[i].name, name) != 0)
		i++;
	return i;
}

static void add_technique(struct judgement *j, struct study *study, const char *name)
{
	if (judge_technique_of(j, name) < j->technique_count)
		return;
	if (j->technique_count == JUDGE_TECHNIQUES)
		study_miss(study, NULL, "technique %.60s: a report has room for %u", name, JUDGE_TECHNIQUES);
	else
		j->techniques[j->technique_count++] = (struct judge_technique){name, figures_converges(name)};
}

// In the order of study.json, then those that have points all the same.
static void list_techniques(struct judgement *j, const struct figures *f)
{
	const json_t *listed = json_object_get(f->study->json, "techniques"), *name;
	size_t i;
	json_array_foreach(listed, i, name)
	{
		for (size_t k = 0; k < f->point_count && json_is_string(name); k++)
			if (strcmp(f->points[k].runs[0].technique, json_string_value(name)) == 0)
				add_technique(j, f->study, f->points[k].runs[0].technique);
	}
	for (i = 0; i < f->point_count; i++)
		add_technique(j, f->study, f->points[i].runs[0].technique);
}

static bool takes_part(const struct point *p, uint32_t view)
{
	return p->runs[0].view == view && isfinite(p->relmse) && isfinite(p->seconds);
}

static bool is_of(const struct point *p, const char *technique)
{
	return strcmp(p->runs[0].technique, technique) == 0;
}

const struct point *judge_best(const struct figures *f, uint32_t view, const char *technique)
{
	const struct point *best = NULL;
	for (size_t i = 0; i < f->point_count; i++)
		if (takes_part(&f->points[i], view) && is_of(&f->points[i], technique) &&
		    (!best || f->points[i].relmse < best->relmse))
			best = &f->points[i];
	return best;
}

// Whether the error of `a` is lower than that of `b` by more than the seeds' and the reference's chance; of unknown
// intervals never.
static bool told_below(const struct point *a, const struct point *b)
{
	return a->relmse_interval.high < b->relmse_interval.low;
}

bool judge_comparable(const struct point *a, const struct point *b)
{
	return isfinite(a->relmse_interval.high) && isfinite(b->relmse_interval.high);
}

// ---- floors ----

// The point with the same settings and the most samples below this one's. NULL: there is none.
static const struct point *before(const struct figures *f, const struct point *p)
{
	const struct point *found = NULL;
	for (size_t i = 0; i < f->point_count; i++) {
		const struct point *q = &f->points[i];
		if (q->runs[0].view == p->runs[0].view && isfinite(q->relmse) && q->runs[0].samples < p->runs[0].samples &&
		    study_same_but_samples(&q->runs[0], &p->runs[0]) &&
		    (!found || q->runs[0].samples > found->runs[0].samples))
			found = q;
	}
	return found;
}

// Noise of which so much of an error consists is as good as none.
#define NOISE_SHARE 0.05

static double noise_of(const struct point *p)
{
	return p->relmse_noise > 0 ? p->relmse_noise : 0;
}

// What of an error is no noise. More samples would take the noise away.
static double level_of(const struct point *p)
{
	return fmax(0, p->relmse - noise_of(p));
}

// Whether an error is known well enough to say that it has stopped falling: less than half of it is noise, and the interval
// of what is left holds neither half nor twice of that.
static bool is_firm(const struct point *p)
{
	return p->relmse_noise <= p->relmse / 2 && p->seeds_interval.low - noise_of(p) >= level_of(p) / 2 &&
	       p->seeds_interval.high - noise_of(p) <= 2 * level_of(p);
}

// The reference's own error is the same in both, so that the seeds alone say whether they differ.
static enum judge_fall fall_of(const struct point *p, const struct point *earlier)
{
	if (!earlier || !isfinite(p->seeds_interval.high) || !isfinite(earlier->seeds_interval.low))
		return JUDGE_UNKNOWN;
	if (p->seeds_interval.high < earlier->seeds_interval.low)
		return JUDGE_FALLING;
	return is_firm(p) ? JUDGE_HELD : JUDGE_UNKNOWN;
}

static bool has_most_samples(const struct figures *f, const struct point *p, uint32_t view, const char *technique)
{
	if (p->runs[0].view != view || !is_of(p, technique) || !isfinite(p->relmse))
		return false;
	for (size_t k = 0; k < f->point_count; k++) {
		const struct point *q = &f->points[k];
		if (q->runs[0].view == view && isfinite(q->relmse) && q->runs[0].samples > p->runs[0].samples &&
		    study_same_but_samples(&p->runs[0], &q->runs[0]))
			return false;
	}
	return true;
}

static struct judge_floor find_floor(const struct figures *f, uint32_t view, const struct judge_technique *technique)
{
	struct judge_floor floor = {0};
	enum judge_fall others = JUDGE_UNKNOWN;
	for (size_t i = 0; i < f->point_count && !technique->converges; i++) {
		const struct point *p = &f->points[i];
		if (!has_most_samples(f, p, view, technique->name))
			continue;
		const enum judge_fall fall = fall_of(p, before(f, p));
		others = others == JUDGE_FALLING || fall == JUDGE_UNKNOWN ? others : fall;
		if (!floor.point || level_of(p) < level_of(floor.point))
			floor.point = p;
	}
	const struct point *lowest = floor.point;
	if (!lowest)
		return floor;
	floor.before = before(f, lowest);
	floor.fall = fall_of(lowest, floor.before);
	floor.by_others = floor.fall == JUDGE_UNKNOWN && is_firm(lowest) && noise_of(lowest) <= NOISE_SHARE * lowest->relmse;
	if (floor.by_others)
		floor.fall = others;
	floor.level = level_of(lowest);
	floor.interval = (struct interval){fmax(0, lowest->relmse_interval.low - noise_of(lowest)),
					   fmax(0, lowest->relmse_interval.high - noise_of(lowest))};
	if (isnan(lowest->relmse_interval.low))
		floor.interval = lowest->relmse_interval;
	floor.resolved = floor.level > 0 && floor.level >= figures_own_high(&f->views[view]);
	return floor;
}

double judge_level(const struct judge_floor *floor)
{
	return floor->point && floor->resolved && floor->fall == JUDGE_HELD ? floor->level : (double)NAN;
}

double judge_floor_of_all(const struct judgement *j, size_t technique)
{
	double sum = 0;
	for (uint32_t view = 0; view < j->view_count; view++)
		sum += judge_level(&j->views[view].floors[technique]);
	return sum / j->view_count;
}

// ---- who wins ----

static int by_seconds(const void *a, const void *b)
{
	const struct point *x = *(const struct point *const *)a, *y = *(const struct point *const *)b;
	if (x->seconds != y->seconds)
		return x->seconds > y->seconds ? 1 : -1;
	return (x->relmse > y->relmse) - (x->relmse < y->relmse);
}

// The most accurate point before `end` seconds of other techniques than a span's, if it is not told apart.
static const struct point *rival_of(const struct judgement *j, const struct judge_span *span, double end,
				    const struct point *const *sorted, size_t count)
{
	const struct point *rival = NULL;
	for (size_t i = 0; i < count && sorted[i]->seconds < end; i++)
		if (!is_of(sorted[i], j->techniques[span->technique].name) && (!rival || sorted[i]->relmse < rival->relmse))
			rival = sorted[i];
	return rival && !told_below(span->best, rival) ? rival : NULL;
}

static void find_spans(const struct judgement *j, struct judge_view *v, const struct point *const *sorted, size_t count)
{
	const struct point *best = NULL;
	for (size_t i = 0; i < count && (!best || best->resolved); i++) {
		if (best && sorted[i]->resolved && !(sorted[i]->relmse < best->relmse))
			continue;
		best = sorted[i];
		const size_t technique = judge_technique_of(j, best->runs[0].technique);
		struct judge_span *last = v->span_count ? &v->spans[v->span_count - 1] : NULL;
		if (!last || last->technique != technique || !best->resolved)
			v->spans[v->span_count++] = (struct judge_span){technique, best, best, NULL};
		else
			last->best = best;
	}
	for (size_t i = 0; i < v->span_count; i++) {
		const double end = i + 1 < v->span_count ? v->spans[i + 1].first->seconds : (double)INFINITY;
		v->spans[i].rival = rival_of(j, &v->spans[i], end, sorted, count);
	}
}

static void find_overtake(const struct judgement *j, struct judge_view *v, size_t winner, size_t loser,
			  const struct point *const *sorted, size_t count)
{
	const char *const names[2] = {j->techniques[winner].name, j->techniques[loser].name};
	const struct point *best[2] = {NULL, NULL};
	struct judge_overtake o = {.winner = winner, .loser = loser};
	for (size_t i = 0; i < count; i++) {
		const int who = is_of(sorted[i], names[0]) ? 0 : is_of(sorted[i], names[1]) ? 1 : -1;
		if (who < 0)
			continue;
		if (who == 1 && !sorted[i]->resolved)
			return; // how good it is nobody knows
		if (!best[who] || sorted[i]->relmse < best[who]->relmse)
			best[who] = sorted[i];
		if (!best[0] || (best[1] && !told_below(best[0], best[1]))) {
			o.point = NULL;
		} else if (!o.point) {
			// The one that came now may be the loser's, and better, but known more closely than its last.
			o.point = best[0];
			o.seconds = sorted[i]->seconds;
			o.from_first = !best[1];
		}
	}
	if (!best[0] || !best[1])
		return;
	if (!o.point)
		o.seconds = (double)NAN;
	o.closer = best[0]->relmse < best[1]->relmse;
	o.comparable = judge_comparable(best[0], best[1]);
	v->overtakes[v->overtake_count++] = o;
}

// ---- rows ----

// Up to two significant digits.
static double round_up(double x)
{
	const double unit = pow(10, floor(log10(x)) - 1);
	return ceil(x / unit - 1e-9) * unit;
}

static void add_row(const struct judgement *j, struct judge_view *v, bool is_time, double target,
		    const struct point *const *sorted, size_t count)
{
	struct judge_row row = {.is_time = is_time, .target = round_up(target)};
	bool any = false;
	for (size_t t = 0; t < j->technique_count; t++) {
		const struct point *best = NULL;
		// In the order of time: for an equal error the first that is good enough.
		for (size_t i = 0; i < count; i++) {
			const struct point *p = sorted[i];
			if (!is_of(p, j->techniques[t].name) || (is_time ? p->seconds : p->relmse) > row.target || !p->shown)
				continue;
			if (!is_time && !p->resolved)
				row.unresolved[t] = true;
			else if (!best || (is_time && p->relmse < best->relmse))
				best = p;
		}
		row.points[t] = best;
		row.unresolved[t] = row.unresolved[t] && !best;
		any = any || best;
	}
	for (size_t i = 0; i < v->row_count; i++)
		any = any && (v->rows[i].is_time != is_time || v->rows[i].target != row.target);
	if (any)
		v->rows[v->row_count++] = row;
}

// Times from that in which every technique has something to the longest, evenly in their logarithm.
static void find_equal_times(const struct judgement *j, struct judge_view *v, const struct point *const *sorted,
			     size_t count)
{
	double first = 0;
	const double last = sorted[count - 1]->seconds;
	for (size_t t = 0; t < j->technique_count; t++)
		for (size_t i = 0; i < count; i++)
			if (is_of(sorted[i], j->techniques[t].name)) {
				first = fmax(first, sorted[i]->seconds);
				break;
			}
	for (unsigned k = 0; k < JUDGE_TARGETS; k++)
		add_row(j, v, true, first * pow(last / first, (double)k / (JUDGE_TARGETS - 1)), sorted, count);
}

static int descending(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x < y) - (x > y);
}

// Errors: the floors, which is where techniques part; without any, those from the worst best to the best of all.
static void find_equal_errors(const struct judgement *j, struct judge_view *v, const struct point *const *sorted,
			      size_t count)
{
	double bests[JUDGE_TECHNIQUES];
	size_t known = 0;
	for (size_t t = 0; t < j->technique_count; t++) {
		double best = (double)INFINITY;
		for (size_t i = 0; i < count; i++)
			if (is_of(sorted[i], j->techniques[t].name) && sorted[i]->resolved)
				best = fmin(best, sorted[i]->relmse);
		if (isfinite(best))
			bests[known++] = best;
	}
	qsort(bests, known, sizeof *bests, descending);
	for (size_t k = 0; k < known && k < JUDGE_TARGETS; k++)
		add_row(j, v, false, bests[k], sorted, count);
}

enum status judge(const struct figures *f, struct judgement *j, struct error *err)
{
	*j = (struct judgement){.view_count = f->study->views};
	list_techniques(j, f);
	j->views = calloc(j->view_count, sizeof *j->views);
	const struct point **sorted = calloc(f->point_count + 1, sizeof *sorted);
	enum status s = j->views && sorted ? STATUS_OK : error_set(err, STATUS_MEMORY, "no memory to compare points");
	for (uint32_t view = 0; view < j->view_count && s == STATUS_OK; view++) {
		struct judge_view *v = &j->views[view];
		size_t count = 0;
		for (size_t i = 0; i < f->point_count; i++)
			if (takes_part(&f->points[i], view) &&
			    judge_technique_of(j, f->points[i].runs[0].technique) < j->technique_count)
				sorted[count++] = &f->points[i];
		for (size_t t = 0; t < j->technique_count; t++)
			v->floors[t] = find_floor(f, view, &j->techniques[t]);
		v->spans = calloc(count + 1, sizeof *v->spans);
		if (!v->spans)
			s = error_set(err, STATUS_MEMORY, "no memory to compare points");
		if (!v->spans || count == 0)
			continue;
		qsort(sorted, count, sizeof *sorted, by_seconds);
		find_spans(j, v, sorted, count);
		for (size_t t = 0; t < j->technique_count; t++)
			for (size_t k = 0; k < j->technique_count; k++)
				if (j->techniques[t].converges && !j->techniques[k].converges)
					find_overtake(j, v, t, k, sorted, count);
		find_equal_times(j, v, sorted, count);
		find_equal_errors(j, v, sorted, count);
	}
	free(sorted);
	return s;
}

void judge_finish(struct judgement *j)
{
	for (uint32_t view = 0; j->views && view < j->view_count; view++)
		free(j->views[view].spans);
	free(j->views);
	*j = (struct judgement){0};
}
