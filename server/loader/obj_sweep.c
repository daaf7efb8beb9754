#include "server/loader/obj_sweep.h"

#include <bsd/sys/tree.h>
#include <math.h>
#include <stdlib.h>

// What happens at a corner. Of those at one place, the sweep meets them in this order: what ends there makes room for what
// begins, and what begins between two sides needs these to be there.
enum event {
	END, // both its sides come from below, with the inside between them
	JOIN, // both come from below, and the inside is around
	PASS, // one comes from below
	SPLIT, // both go up, and the inside is around
	OPEN, // both go up, with the inside between them
};

// What of the sweeping line lies inside, between two sides of the polygon. A side is named by the corner that it goes from.
struct interval {
	RB_ENTRY(interval) entry;
	struct sweep *sweep;
	uint32_t left, right; // this one goes down and that one up, because the inside is left of all sides
	uint32_t last; // corner that the line met in the interval or on its sides
	bool is_joint; // where two intervals became one: a cut goes up from there
};

RB_HEAD(line, interval);

struct sweep {
	struct obj_sweep_corner *corners;
	uint32_t count;
	struct interval *intervals;
	uint32_t interval_count; // all that there ever were
	struct line line; // from left to right
	uint32_t now, left_end; // an interval that begins: its corner, and the upper end of the left one of its sides
	struct obj_sweep_cut *cuts;
	uint32_t cut_count;
	uint64_t comparisons;
};

static uint32_t before(const struct sweep *s, uint32_t i)
{
	return i > 0 ? i - 1 : s->count - 1;
}

static uint32_t after(const struct sweep *s, uint32_t i)
{
	return i + 1 < s->count ? i + 1 : 0;
}

static enum event event_at(const struct sweep *s, uint32_t i)
{
	const int64_t *at = s->corners[i].at, *last = s->corners[before(s, i)].at, *next = s->corners[after(s, i)].at;
	const int below = (obj_sweep_compare(last, at) < 0) + (obj_sweep_compare(next, at) < 0);
	if (below == 1)
		return PASS;
	const bool is_between = obj_sweep_area(last, at, next) > 0;
	return below == 2 ? (is_between ? END : JOIN) : is_between ? OPEN : SPLIT;
}

// The other end of the left one of a corner's sides, if both go up or come from below.
static uint32_t left_end(const struct sweep *s, uint32_t i, enum event event)
{
	return event == END || event == SPLIT ? after(s, i) : before(s, i);
}

static uint32_t right_end(const struct sweep *s, uint32_t i, enum event event)
{
	return event == END || event == SPLIT ? before(s, i) : after(s, i);
}

// Of two corners at one place, the sides of both of which go up: the outer first, between whose sides the others are. Of two
// that end there, the inner.
static int compare_nested(const struct sweep *s, uint32_t a, enum event first, uint32_t b, enum event second)
{
	const struct obj_sweep_corner *c = s->corners;
	const obj_area left = obj_sweep_area(c[a].at, c[left_end(s, b, second)].at, c[left_end(s, a, first)].at);
	const obj_area right = obj_sweep_area(c[a].at, c[right_end(s, a, first)].at, c[right_end(s, b, second)].at);
	if (left != 0)
		return left > 0 ? -1 : 1;
	return right != 0 ? (right > 0 ? -1 : 1) : (int)first - (int)second;
}

static int compare_corners(const void *pa, const void *pb, void *sweep)
{
	struct sweep *s = sweep;
	const uint32_t a = *(const uint32_t *)pa, b = *(const uint32_t *)pb;
	int order = obj_sweep_compare(s->corners[a].at, s->corners[b].at);
	s->comparisons++;
	if (order == 0) {
		const enum event first = event_at(s, a), second = event_at(s, b);
		const bool same_way = (first < PASS && second < PASS) || (first > PASS && second > PASS);
		order = same_way ? compare_nested(s, a, first, b, second) : (int)first - (int)second;
	}
	return order != 0 ? order : (a > b) - (a < b);
}

// Where an interval that begins lies: left of another, -1, or right of it. If it begins on the other's left side, that goes
// on left of it or not. The other's right side need not be asked: nothing begins between the two but a split, and that
// belongs behind.
static int compare_intervals(const struct interval *begins, const struct interval *other)
{
	struct sweep *s = begins->sweep;
	const struct obj_sweep_corner *c = s->corners;
	const int64_t *at = c[s->now].at, *upper = c[other->left].at, *lower = c[after(s, other->left)].at;
	const obj_area side = obj_sweep_area(lower, upper, at);
	s->comparisons++;
	if (side != 0)
		return side > 0 ? -1 : 1;
	return obj_sweep_area(at, c[s->left_end].at, upper) < 0 ? -1 : 1;
}

RB_GENERATE_INTERNAL(line, interval, entry, compare_intervals, __attribute__((unused)) static)

static struct interval *interval_of(const struct sweep *s, uint32_t side)
{
	return &s->intervals[s->corners[side].interval];
}

static void fill(struct sweep *s, struct interval *x, uint32_t left, uint32_t right, uint32_t last, bool is_joint)
{
	x->left = left;
	x->right = right;
	x->last = last;
	x->is_joint = is_joint;
	s->corners[left].interval = s->corners[right].interval = (uint32_t)(x - s->intervals);
}

static void cut(struct sweep *s, uint32_t a, uint32_t b)
{
	s->cuts[s->cut_count++] = (struct obj_sweep_cut){.from = a < b ? a : b, .to = a < b ? b : a};
}

// How far corner i lies right of a side; negative: left of it.
static double distance(const struct sweep *s, uint32_t lower, uint32_t upper, uint32_t i)
{
	const int64_t *a = s->corners[lower].at, *b = s->corners[upper].at;
	return -(double)obj_sweep_area(a, b, s->corners[i].at) / hypot((double)(b[0] - a[0]), (double)(b[1] - a[1]));
}

static double from_left(const struct sweep *s, const struct interval *x, uint32_t i)
{
	return distance(s, after(s, x->left), x->left, i);
}

static double from_right(const struct sweep *s, const struct interval *x, uint32_t i)
{
	return -distance(s, x->right, after(s, x->right), i);
}

// An interval begins. If it does so within another, its corner should lie on a side of that, and was rounded to the wrong
// side of it: it goes to the nearer one.
static void open_at(struct sweep *s, uint32_t i, struct interval *x)
{
	struct interval *left = line_RB_PREV(x);
	const bool is_left = left && from_right(s, left, i) > from_left(s, left, i);
	if (is_left)
		fill(s, x, left->left, left->right, left->last, left->is_joint);
	fill(s, is_left ? left : x, before(s, i), i, i, false);
}

// An interval becomes two. If the corner lies within none, it was rounded likewise.
static void split_at(struct sweep *s, uint32_t i, struct interval *x)
{
	struct interval *left = line_RB_PREV(x), *right = line_RB_NEXT(x);
	const bool is_right = right && (!left || from_left(s, right, i) > from_right(s, left, i));
	const struct interval *split = is_right ? right : left; // there is one, unless the polygon crosses itself
	const uint32_t sides[2] = {split ? split->left : before(s, i), split ? split->right : i};
	if (split) {
		cut(s, split->last, i);
		fill(s, is_right ? x : left, sides[0], i, i, false);
	}
	fill(s, is_right ? right : x, before(s, i), sides[1], i, false);
}

static void begin(struct sweep *s, uint32_t i, enum event event)
{
	struct interval *x = &s->intervals[s->interval_count++];
	*x = (struct interval){.sweep = s};
	s->now = i;
	s->left_end = left_end(s, i, event);
	line_RB_INSERT(&s->line, x);
	if (event == SPLIT)
		split_at(s, i, x);
	else
		open_at(s, i, x);
}

static void pass(struct sweep *s, uint32_t i)
{
	const bool goes_up = obj_sweep_compare(s->corners[before(s, i)].at, s->corners[i].at) < 0;
	struct interval *x = interval_of(s, goes_up ? before(s, i) : i);
	if (x->is_joint)
		cut(s, x->last, i);
	fill(s, x, goes_up ? x->left : before(s, i), goes_up ? i : x->right, i, false);
}

// An interval ends, or two become one.
static void close_at(struct sweep *s, uint32_t i)
{
	struct interval *left = interval_of(s, before(s, i)), *right = interval_of(s, i);
	if (right->is_joint)
		cut(s, right->last, i);
	if (left != right && left->is_joint)
		cut(s, left->last, i);
	if (left != right)
		fill(s, left, left->left, right->right, i, true);
	line_RB_REMOVE(&s->line, right);
}

static void sweep(struct sweep *s, const uint32_t *order)
{
	for (uint32_t k = 0; k < s->count; k++) {
		const uint32_t i = order[k];
		const enum event event = event_at(s, i);
		s->corners[i].rank = k;
		if (event < PASS)
			close_at(s, i);
		else if (event == PASS)
			pass(s, i);
		else
			begin(s, i, event);
	}
}

enum status obj_sweep(struct obj_sweep_corner *corners, uint32_t count, struct obj_sweep_cut *cuts, uint32_t *cut_count,
		      uint64_t *comparisons, struct error *err)
{
	struct sweep s = {.corners = corners, .count = count, .cuts = cuts};
	uint32_t *order = malloc(count * sizeof *order);
	s.intervals = malloc((count / 2 + 1) * sizeof *s.intervals); // at most every second corner begins one
	const bool enough = order && s.intervals;
	for (uint32_t i = 0; enough && i < count; i++)
		order[i] = i;
	if (enough) {
		qsort_r(order, count, sizeof *order, compare_corners, &s);
		sweep(&s, order);
	}
	free(s.intervals);
	free(order);
	*cut_count = s.cut_count;
	*comparisons += s.comparisons;
	return enough ? STATUS_OK : error_set(err, STATUS_MEMORY, "no memory for a face of %u corners", count);
}
