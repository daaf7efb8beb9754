// What the points of a study say when they are held beside one another: floors, who wins up to when, who overtakes whom, and
// what each technique makes of an equal time or an equal error. Nothing is interpolated: a statement is about points that
// were rendered. One thread. All pointers lead into the figures.
//
// A floor is the error that a technique without noise keeps, whatever time it gets. Of each combination of its settings but
// the samples, take the point with the most samples; the floor is the least relMSE of these. A technique with noise has
// none.
#ifndef CANDIL_REPORT_JUDGE_H
#define CANDIL_REPORT_JUDGE_H

#include "server/report/figures.h"

#define JUDGE_TECHNIQUES 16u // of one study; the points of further ones are left out and named as missing
#define JUDGE_TARGETS 3u // equal times, and equal errors, of each view

struct judge_technique {
	const char *name;
	bool noise;
};

// From `from` seconds on the technique has the least relMSE of all that are done by then; until the next span of the view.
struct judge_span {
	size_t technique;
	const struct point *first, *best; // the point that begins the span, and the most accurate by its end
};

// When a technique with noise is better than one without, and stays so. `point`: the first that does; NULL: none in the
// study.
struct judge_overtake {
	size_t winner, loser;
	const struct point *point;
};

// For equal times the most accurate point of each technique within the target, for equal errors the quickest; NULL: none.
struct judge_row {
	bool is_time; // the target is in seconds, else a relMSE
	double target;
	const struct point *points[JUDGE_TECHNIQUES];
};

struct judge_view {
	const struct point *floors[JUDGE_TECHNIQUES]; // NULL: none
	struct judge_span *spans;
	size_t span_count;
	struct judge_overtake overtakes[JUDGE_TECHNIQUES * JUDGE_TECHNIQUES / 4];
	size_t overtake_count;
	struct judge_row rows[2 * JUDGE_TARGETS];
	size_t row_count;
};

struct judgement {
	struct judge_technique techniques[JUDGE_TECHNIQUES];
	size_t technique_count;
	struct judge_view *views;
	uint32_t view_count;
};

// STATUS_MEMORY. Points without an error or a time take no part.
enum status judge(const struct figures *figures, struct judgement *judgement, struct error *err);
void judge_finish(struct judgement *judgement); // a zeroed one is fine

// The number of a technique in the judgement; technique_count: it has none.
size_t judge_technique_of(const struct judgement *judgement, const char *name);

// The most accurate point of a technique in a view; NULL: none.
const struct point *judge_best(const struct figures *figures, uint32_t view, const char *technique);

// The floor of a technique over all views, as if these were one picture: the mean. NaN unless every view has one.
double judge_floor(const struct judgement *judgement, size_t technique);

#endif
