// What the points of a study say when they are held beside one another: floors, who wins up to when, who overtakes whom, and
// what each technique makes of an equal time or an equal error. Nothing is interpolated: a statement is about points that
// were rendered. One thread. All pointers lead into the figures.
//
// A floor is the error that a technique which does not converge keeps, whatever samples it gets. Of each combination of its
// settings but the samples, take the point with the most samples, and of its relMSE the part that is no noise, which more
// samples would take away: the lowest of these levels is its floor if the error has stopped falling. It has if the last two
// sample counts do not differ beyond the intervals of their seeds, less than half of it is noise, and the level's interval
// holds neither half nor twice of it. Settings that were rendered with one sample count alone are judged by the others of
// the technique if hardly any of it is noise, and are unknown without any.
//
// Errors are told apart only where their intervals do not overlap. Points that are not resolved have no rank.
#ifndef CANDIL_REPORT_JUDGE_H
#define CANDIL_REPORT_JUDGE_H

#include "server/report/figures.h"

#define JUDGE_TECHNIQUES 16u // of one study; the points of further ones are left out and named as missing
#define JUDGE_TARGETS 3u // equal times, and equal errors, of each view

struct judge_technique {
	const char *name;
	bool converges; // figures_converges
};

enum judge_fall { JUDGE_UNKNOWN, JUDGE_FALLING, JUDGE_HELD };

struct judge_floor {
	const struct point *point; // that with the lowest level; NULL: none
	const struct point *before; // the same settings with the sample count before; NULL: none
	enum judge_fall fall;
	bool by_others; // `fall` is that of other settings of the technique, for of its own it is unknown
	double level; // the point's relMSE less its noise
	struct interval interval; // of the level, by the seeds and the reference's own interval
	bool resolved; // the level is above the upper end of the reference's own error
};

// From the time of `first` on the technique has the least relMSE of all that are done by then; until the next span of the
// view. A span whose best point is not resolved is the last: from there on nothing can be said.
struct judge_span {
	size_t technique;
	const struct point *first, *best; // the point that begins the span, and the most accurate by its end
	const struct point *rival; // the most accurate by then of all others, if it is not told apart from `best`; else NULL
};

// When a technique that converges is better than one that does not, and stays so within the study. `point`: the winner's
// most accurate by then, which is told apart from all that the loser has; NULL: none is. Then `closer`: the winner's best
// has the lower error all the same.
struct judge_overtake {
	size_t winner, loser;
	const struct point *point;
	double seconds; // by when both are done that are told apart; NaN: they never are
	bool from_first; // the loser has no picture by then: the winner is ahead from its own first one
	bool closer;
	bool comparable; // the bests of both have intervals
};

// For equal times the most accurate point of each technique within the target, for equal errors the quickest that is
// resolved; NULL: none.
struct judge_row {
	bool is_time; // the target is in seconds, else a relMSE
	double target;
	const struct point *points[JUDGE_TECHNIQUES];
	bool unresolved[JUDGE_TECHNIQUES]; // there is one, of an equal error, but it is within the reference's own
};

struct judge_view {
	struct judge_floor floors[JUDGE_TECHNIQUES];
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

// Whether both errors have an interval; without one nothing is told apart.
bool judge_comparable(const struct point *a, const struct point *b);

// The level of a floor that is one: resolved, and held. Else NaN.
double judge_level(const struct judge_floor *floor);

// The floor of a technique over all views, as if these were one picture: the mean. NaN unless every view has one.
double judge_floor_of_all(const struct judgement *judgement, size_t technique);

#endif
